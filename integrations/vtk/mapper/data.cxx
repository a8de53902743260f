#include "data.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkSmartPointer.h"

namespace chiaro::from_vtk {
namespace {

Vec3 column(const vtkMatrix4x4& m, int c) { return {m.GetElement(0, c), m.GetElement(1, c), m.GetElement(2, c)}; }

/// Whether the matrix keeps angles: rotations, moves, one scale.
bool is_similarity(const vtkMatrix4x4& m) {
    const Vec3 x = column(m, 0), y = column(m, 1), z = column(m, 2);
    const double scale = length(x), tolerance = 1e-6 * scale;
    return dot(cross(x, y), z) > 0 && std::abs(length(y) - scale) < tolerance &&
           std::abs(length(z) - scale) < tolerance && std::abs(dot(x, y)) < tolerance * scale &&
           std::abs(dot(x, z)) < tolerance * scale && std::abs(dot(y, z)) < tolerance * scale;
}

}  // namespace

Placement placement_of(vtkImageData& image, bool at_cells, vtkMatrix4x4& matrix) {
    Placement place{};
    const bool by_camera = is_similarity(matrix);
    for (int i = 0; i < 16; ++i)
        place.world_from_volume[std::size_t(i)] = by_camera ? matrix.GetElement(i / 4, i % 4) : i % 5 == 0;
    place.scale = by_camera ? length(column(matrix, 0)) : 1;
    double spacing[3], first[3];
    int extent[6];
    image.GetSpacing(spacing), image.GetExtent(extent);
    const double middle = at_cells ? 0.5 : 0;
    image.TransformContinuousIndexToPhysicalPoint(extent[0] + middle, extent[2] + middle, extent[4] + middle, first);
    const vtkMatrix3x3& direction = *image.GetDirectionMatrix();
    const auto moved = [&](Vec3 v, double w) {
        if (by_camera) return v;
        const double in[4]{v.x, v.y, v.z, w};
        double out[4];
        matrix.MultiplyPoint(in, out);
        return Vec3{out[0], out[1], out[2]};
    };
    place.geometry.origin_mm = moved({first[0], first[1], first[2]}, 1);
    for (int a = 0; a < 3; ++a) {
        const Vec3 step = moved(
            spacing[a] * Vec3{direction.GetElement(0, a), direction.GetElement(1, a), direction.GetElement(2, a)}, 0);
        place.geometry.spacing_mm[a] = length(step);
        place.geometry.direction[std::size_t(a)] = normalized(step);
    }
    return place;
}

Vec3 turned_back(const Placement& place, Vec3 v) {
    const auto& m = place.world_from_volume;
    const auto along = [&](std::size_t c) { return m[c] * v.x + m[4 + c] * v.y + m[8 + c] * v.z; };
    return {along(0), along(1), along(2)};
}

std::optional<VoxelType> type_of(vtkDataArray& scalars) {
    const int bytes = scalars.GetDataTypeSize();
    switch (scalars.GetDataType()) {
        case VTK_FLOAT:
            return VoxelType::f32;
        case VTK_DOUBLE:
            return VoxelType::f64;
        case VTK_BIT:
            return {};
        default:
            break;
    }
    const bool is_signed = scalars.GetDataTypeMin() < 0;
    if (bytes == 1) return is_signed ? VoxelType::i8 : VoxelType::u8;
    if (bytes == 2) return is_signed ? VoxelType::i16 : VoxelType::u16;
    if (bytes == 4) return is_signed ? VoxelType::i32 : VoxelType::u32;
    return is_signed ? VoxelType::i64 : VoxelType::u64;
}

Volume volume_of(vtkImageData& image, vtkDataArray& scalars, bool at_cells, const Geometry& geometry) {
    Volume volume;
    image.GetDimensions(volume.dimensions.data());
    if (at_cells)
        for (int& n : volume.dimensions) n = std::max(n - 1, 1);
    volume.type = *type_of(scalars);
    volume.components = scalars.GetNumberOfComponents();
    volume.geometry = geometry;
    volume.source = volume.format = "vtkImageData";
    // VTK counts references to an array; the pointer keeps one. Arrays of another layout than a row are made one here.
    const vtkSmartPointer<vtkDataArray> kept(&scalars);
    const auto owner = std::make_shared<vtkSmartPointer<vtkDataArray>>(kept);
    volume.voxels = VoxelBuffer::borrow(
        kept->GetVoidPointer(0), volume.voxel_count() * std::size_t(volume.components) * size_of(volume.type), owner);
    return volume;
}

std::vector<Volume> channels_of(const Volume& voxels, bool dependent) {
    std::vector<Volume> channels = components_of(voxels);
    if (!dependent) return channels;
    std::rotate(channels.begin(), channels.end() - 1, channels.end());  // the last has the opacity
    channels.front().has_own_colors = true;
    channels.front().component_infos = {{"alpha", {}}};
    return channels;
}

void place(Volume& voxels, vtkImageData& grid, vtkImageData* image, bool at_cells, const std::array<int, 6>& own) {
    chiaro::Placement block;
    int whole[6], extent[6]{};
    grid.GetExtent(whole);
    if (image) image->GetExtent(extent);
    for (std::size_t a = 0; a < 3; ++a) {
        block.whole[a] = std::max(whole[2 * a + 1] - whole[2 * a] + (at_cells ? 0 : 1), 1);
        block.first[a] = image ? extent[2 * a] - whole[2 * a] : 0;
        block.own_first[a] = own[2 * a] - whole[2 * a], block.own_end[a] = own[2 * a + 1] - whole[2 * a];
    }
    voxels.placement = block;
}

}  // namespace chiaro::from_vtk
