// NIfTI-1 and NIfTI-2 (https://nifti.nimh.nih.gov/nifti-1, nifti-2). The world is RAS+, in millimetres.
#include "decode/nifti_header.h"
#include "decode/payload.h"
#include "decode/readers.h"
#include "volume/validate.h"

#include <fmt/format.h>

#include <cmath>

namespace chiaro::decode {
namespace {

using Path = std::filesystem::path;

struct Datatype {
    VoxelType type;
    int components = 1;
};

Datatype datatype_of(int code) {
    switch (code) {
        case 2:
            return {VoxelType::u8};
        case 4:
            return {VoxelType::i16};
        case 8:
            return {VoxelType::i32};
        case 16:
            return {VoxelType::f32};
        case 64:
            return {VoxelType::f64};
        case 128:
            return {VoxelType::u8, 3};  // RGB
        case 256:
            return {VoxelType::i8};
        case 512:
            return {VoxelType::u16};
        case 768:
            return {VoxelType::u32};
        case 1024:
            return {VoxelType::i64};
        case 1280:
            return {VoxelType::u64};
        case 2304:
            return {VoxelType::u8, 4};  // RGBA
        default:
            refuse(fmt::format("its datatype is {}; 2, 4, 8, 16, 64, 128, 256, 512, 768, 1024, 1280 and 2304 are read",
                               code));
    }
}

/// What the fourth axis steps through (nifti1.h, xyzt_units).
const char* unit_of_moments(const NiftiHeader& header) {
    switch (header.xyzt_units & 0x38) {
        case 8:
            return "s";
        case 16:
            return "ms";
        case 24:
            return "us";
        case 32:
            return "Hz";
        case 40:
            return "ppm";
        case 48:
            return "rad/s";
        default:
            return "";
    }
}

/// Sets the shape and returns how many volumes there are behind each other.
std::uint64_t set_shape(const NiftiHeader& header, Volume& volume) {
    const auto& dim = header.dim;
    if (dim[0] < 2 || dim[0] > 7) refuse(fmt::format("states {} dimensions, not 2 to 7", dim[0]));
    const std::array<std::int64_t, 3> n{dim[1], dim[2], dim[0] > 2 ? dim[3] : 1};
    const Datatype datatype = datatype_of(header.datatype);
    volume.type = datatype.type;
    volume.components = datatype.components;
    volume.has_own_colors = datatype.components > 1;
    if (const int bits = int(size_of(volume.type)) * volume.components * 8; header.bitpix != bits)
        refuse(fmt::format("states {} bits a voxel, but its datatype {} has {}", header.bitpix, header.datatype, bits));
    checked_bytes(n, volume.components, volume.type);
    volume.dimensions = {int(n[0]), int(n[1]), int(n[2])};
    if (dim[0] == 2) volume.notes.push_back("a picture of two dimensions, taken as one slice");
    std::uint64_t volumes = 1;
    for (std::size_t i = 4; i <= std::size_t(dim[0]); ++i)
        if (dim[i] < 1 || __builtin_mul_overflow(volumes, std::uint64_t(dim[i]), &volumes))
            refuse(fmt::format("states a size of {} along dimension {}", dim[i], i));
    return volumes;
}

/// Times run along the fourth axis; of those behind it the first values are taken. Volumes without a step are counted.
MomentAxis moments_of(const NiftiHeader& header, std::uint64_t volumes, Volume& volume, const Output& output) {
    const std::uint64_t along_time = header.dim[0] > 3 ? std::uint64_t(header.dim[4]) : 1;
    const std::uint64_t moments = along_time > 1 ? along_time : volumes;
    if (volumes > moments)
        volume.notes.push_back(fmt::format("holds {} volumes for each moment; the first is taken", volumes / moments));
    MomentAxis axis{.count = moments, .wanted = output.choose_moment(moments, volume)};
    axis.run = size_of(volume.type) * std::uint64_t(volume.components) * volume.voxel_count();
    if (along_time > 1) set_even_times(volume.moments, header.toffset, header.pixdim[4], unit_of_moments(header));
    return axis;
}

/// Columns of the rotation that the quaternion (b, c, d) stands for; qfac turns the third around (nifti1.h, method 2).
std::array<Vec3, 3> axes_of_qform(const NiftiHeader& header) {
    double b = header.quatern[0], c = header.quatern[1], d = header.quatern[2];
    // Half turns have a = 0, of which 32-bit b, c, d leave a difference whose root would be a turn of its own.
    const double rest = 1 - (b * b + c * c + d * d);
    if (!(rest > -1e-3)) refuse(fmt::format("states the quaternion ({}, {}, {}), which is longer than 1", b, c, d));
    double a = rest < 1e-7 ? 0 : std::sqrt(rest);
    const double norm = std::sqrt(a * a + b * b + c * c + d * d);
    a /= norm, b /= norm, c /= norm, d /= norm;
    const double qfac = header.pixdim[0] < 0 ? -1 : 1;
    return {Vec3{a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)},
            Vec3{2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)},
            qfac * Vec3{2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - c * c - b * b}};
}

double millimetres_per_unit(const NiftiHeader& header, Volume& volume) {
    switch (header.xyzt_units & 7) {
        case 1:
            volume.notes.push_back("lengths were stated in metres");
            return 1000;
        case 3:
            volume.notes.push_back("lengths were stated in micrometres");
            return 0.001;
        default:
            return 1;
    }
}

/// Spacings that are the same but for rounding.
bool agree(const Vec3& a, const Vec3& b) {
    for (int axis = 0; axis < 3; ++axis)
        if (!(std::abs(a[axis] - b[axis]) <= 1e-2 * b[axis])) return false;
    return true;
}

/// sform before qform, as its definition says that the former is the better known; without either there is no frame.
void set_geometry(const NiftiHeader& header, Volume& volume) {
    Geometry& geometry = volume.geometry;
    const double unit = millimetres_per_unit(header, volume);
    bool is_mirrored = false;
    for (int axis = 0; axis < 3; ++axis) {
        const bool flat = axis == 2 && volume.dimensions[2] == 1 && header.pixdim[3] == 0;
        geometry.spacing_mm[axis] = flat ? unit : unit * std::abs(header.pixdim[std::size_t(axis) + 1]);
        is_mirrored = is_mirrored || header.pixdim[std::size_t(axis) + 1] < 0;
    }
    if (is_mirrored && header.sform_code <= 0)
        volume.notes.push_back("pixdim states negative voxel sizes; their magnitudes are taken");
    if (header.sform_code > 0) {
        const auto& s = header.srow;
        const auto column = [&](int i) { return unit * Vec3{s[0][i], s[1][i], s[2][i]}; };
        geometry.world = World::ras;
        geometry.origin_mm = column(3);
        const Vec3 stated = geometry.spacing_mm;
        set_steps(geometry, {column(0), column(1), column(2)});
        if (!agree(stated, geometry.spacing_mm))
            volume.notes.push_back(
                fmt::format("pixdim states voxels of {:.4g} x {:.4g} x {:.4g} mm; those of sform are taken", stated.x,
                            stated.y, stated.z));
    } else if (header.qform_code > 0) {
        geometry.world = World::ras;
        geometry.origin_mm = unit * Vec3{header.qoffset[0], header.qoffset[1], header.qoffset[2]};
        geometry.direction = axes_of_qform(header);
    } else {
        volume.notes.push_back("states neither sform nor qform, so its orientation is unknown");
    }
    check_geometry(geometry);
}

/// A slope of 0 means none; other programs write NaN for the same.
void set_scale(const NiftiHeader& header, Volume& volume) {
    if (!std::isfinite(header.scl_slope) || header.scl_slope == 0 || volume.components > 1) return;
    volume.slope = header.scl_slope;
    if (std::isfinite(header.scl_inter)) volume.intercept = header.scl_inter;
}

Payload payload_from(const NiftiHeader& header, const Path& path, std::uint64_t volumes, const MomentAxis& moments) {
    Payload payload;
    payload.moments = moments;
    payload.big_endian = header.big_endian;
    payload.volumes = volumes;
    const std::uint64_t first = header.detached ? 0 : header.size + 4;
    if (!(header.vox_offset >= 0 && header.vox_offset < 1e15))
        refuse(fmt::format("states the voxel offset {}", header.vox_offset));
    // 0 is what writers leave who mean "right behind the header".
    const std::uint64_t offset = header.vox_offset == 0 ? first : std::uint64_t(header.vox_offset);
    if (offset < first) refuse(fmt::format("states that its voxels begin at byte {}, within the header", offset));
    Path file = path;
    if (header.detached) {
        const std::string name = path.filename().string();
        const std::string stem = name.substr(0, name.rfind(".hdr"));
        file = confined(path, stem + ".img");
        if (!std::filesystem::exists(file)) file = confined(path, stem + ".img.gz");
    }
    payload.files = {file};
    payload.encoding = is_gzip(file) ? Encoding::deflated : Encoding::raw;
    (payload.encoding == Encoding::raw ? payload.offset : payload.skip) = offset;
    return payload;
}

}  // namespace

Volume read_nifti(const Path& path, const std::string&, Output& output) {
    const NiftiHeader header = read_nifti_header(path);
    Volume volume;
    volume.format = header.size == 540 ? "NIfTI-2" : "NIfTI";
    const std::uint64_t volumes = set_shape(header, volume);
    set_geometry(header, volume);
    set_scale(header, volume);
    if (!header.description.empty()) volume.key_values["descrip"] = header.description;
    const MomentAxis moments = moments_of(header, volumes, volume, output);
    read_voxels(payload_from(header, path, volumes, moments), volume, output);
    return volume;
}

}  // namespace chiaro::decode
