#include "hostile/seeds.h"

#include "hostile/chunked_seeds.h"
#include "illumination/histogram/cache.h"
#include "illumination/histogram/hash.h"
#include "image/exr.h"
#include "tiff_files.h"
#include "volume_files.h"
#include "vtk_files.h"

#include <chiaro/chiaro.h>

namespace hostile {
namespace {

using namespace chiaro;
using namespace volume_files;

std::string text(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string gzipped(std::string bytes) { return deflated(bytes); }

void add_nrrd(std::vector<Seed>& all) {
    const std::string start = "NRRD0004\n# made for tests\ntype: short\ndimension: 3\nsizes: 4 3 2\nendian: little\n",
                      place =
                          "space: left-posterior-superior\nspace directions: (0.5,0,0) (0,2,0) (0,0,3)\nspace "
                          "origin: (1,-2,3.5)\nmodality:=CT\n",
                      voxels = bytes_of_all(ramp<std::int16_t>(24, -7));
    all.push_back({.name = "attached.nrrd", .bytes = start + place + "encoding: raw\n\n" + voxels, .is_text = true});
    all.push_back({.name = "packed.nrrd", .bytes = start + "encoding: gzip\n\n" + deflated(voxels)});
    all.push_back({.name = "numbers.nrrd",
                   .bytes = "NRRD0001\ntype: float\ndimension: 3\nsizes: 3 2 1\nspacings: 1 2 3\nencoding: ascii\n\n"
                            "10 -20 3e1\n0.125 17 250\n",
                   .is_text = true});
    all.push_back({.name = "list.nrrd",
                   .bytes = "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 4 3 2\nkinds: list space space space\n"
                            "encoding: raw\n\n" +
                            std::string(48, 'v'),
                   .is_text = true});
    all.push_back(
        {.name = "moments.nrrd",
         .bytes = "NRRD0005\ntype: short\ndimension: 4\nsizes: 4 3 2 2\nkinds: domain domain time domain\n"
                  "spacings: 1 1 0.5 2\nunits: \"mm\" \"mm\" \"s\" \"mm\"\nendian: little\nencoding: raw\n\n" +
                  bytes_of_all(ramp<std::int16_t>(48, -7)),
         .is_text = true});
    const std::string header = start + place + "encoding: raw\ndata file: beside.raw\n";
    all.push_back({.name = "detached.nhdr", .bytes = header, .beside = {{"beside.raw", voxels}}, .is_text = true});
    all.push_back(
        {.name = "beside.raw", .bytes = voxels, .beside = {{"detached.nhdr", header}}, .opened = "detached.nhdr"});
    all.push_back({.name = "slices.nhdr",
                   .bytes = start + "encoding: raw\ndata file: s%02d.raw 1 2 1\n",
                   .beside = {{"s01.raw", voxels.substr(0, 24)}, {"s02.raw", voxels.substr(24)}},
                   .is_text = true});
}

void add_meta(std::vector<Seed>& all) {
    const std::string start =
                          "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = True\n"
                          "ElementType = MET_USHORT\nDimSize = 4 3 2\nElementSpacing = 1 2 0.5\nOffset = 1 2 3\n"
                          "TransformMatrix = 1 0 0 0 1 0 0 0 1\n",
                      voxels = bytes_of_all(ramp<std::uint16_t>(24), true), local = "ElementDataFile = LOCAL\n";
    all.push_back({.name = "attached.mha", .bytes = start + local + voxels, .is_text = true});
    all.push_back({.name = "packed.mha", .bytes = start + "CompressedData = True\n" + local + deflated(voxels, 15)});
    const std::string header = start + "ElementDataFile = beside.bin\n";
    all.push_back({.name = "detached.mhd", .bytes = header, .beside = {{"beside.bin", voxels}}, .is_text = true});
    all.push_back(
        {.name = "beside.bin", .bytes = voxels, .beside = {{"detached.mhd", header}}, .opened = "detached.mhd"});
}

void add_nifti(std::vector<Seed>& all) {
    Nifti one(16, 32), big(4, 16, true), pair(2, 8);
    one.qform(0.5F, 0.5F, 0.5F, {1, 2, 3});
    big.sform({2, 0, 0, 1, 0, -2, 0, 2, 0, 0, 2, 3});
    pair.set<float>(108, 0).set<char>(345, 'i');
    auto moments = Nifti(2, 8).set<std::int16_t>(40, 4).set<std::int16_t>(48, 3).set<float>(92, 40);
    moments.set<std::uint8_t>(123, 18);  // mm and ms
    const std::string floats = bytes_of_all(ramp<float>(24)), bytes = std::string(24, 'v');
    all.push_back({.name = "one.nii", .bytes = one.bytes() + floats});
    all.push_back({.name = "moments.nii", .bytes = moments.bytes() + std::string(72, 'v')});
    all.push_back({.name = "big.nii", .bytes = big.bytes() + bytes_of_all(ramp<std::int16_t>(24), true)});
    all.push_back({.name = "inside.nii.gz", .bytes = one.bytes() + floats, .packed = gzipped});
    all.push_back({.name = "outside.nii.gz", .bytes = deflated(one.bytes() + floats)});
    all.push_back({.name = "pair.hdr", .bytes = pair.bytes().substr(0, 348), .beside = {{"pair.img", bytes}}});
    all.push_back({.name = "pair.img",
                   .bytes = bytes,
                   .beside = {{"pair.hdr", pair.bytes().substr(0, 348)}},
                   .opened = "pair.hdr"});
}

void add_dicom(std::vector<Seed>& all) {
    Dicom first, second;
    second.instance = 2;
    second.position[2] = 1.5;
    all.push_back({.name = "slice.dcm", .bytes = first.bytes()});
    all.push_back({.name = "b.dcm", .bytes = second.bytes(), .beside = {{"a.dcm", first.bytes()}}, .opened = "."});
}

/// VTK's files that name others: each is damaged while those are whole, and one of those while it is.
void add_named_vtk(std::vector<Seed>& all) {
    const auto piece = [](const std::string& extent, std::size_t voxels) {
        Vti part{.arrays = {{.values = std::string(voxels, 'v')}}};
        part.extent = extent;
        return part.bytes();
    };
    const std::string left = piece("0 1 0 2 0 1", 12), right = piece("1 3 0 2 0 1", 18);
    const std::string pieces =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PImageData\">\n<PImageData WholeExtent=\"0 3 0 2 0 1\" "
        "GhostLevel=\"1\" Origin=\"1 2 3\" Spacing=\"0.5 2 3\">\n"
        "<Piece Extent=\"0 1 0 2 0 1\" Source=\"left.vti\"/>\n<Piece Extent=\"1 3 0 2 0 1\" Source=\"right.vti\"/>\n"
        "</PImageData>\n</VTKFile>\n";
    const std::string moments =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\">\n<Collection>\n"
        "<DataSet timestep=\"0.5\" group=\"\" part=\"0\" file=\"pieces.pvti\"/>\n"
        "<DataSet timestep=\"2\" group=\"\" part=\"0\" file=\"left.vti\"/>\n</Collection>\n</VTKFile>\n";
    const auto add = [&](const std::string& name, const std::string& bytes, const std::string& opened,
                         std::vector<std::pair<std::string, std::string>> beside) {
        all.push_back({.name = name, .bytes = bytes, .beside = std::move(beside), .opened = opened, .is_text = true});
    };
    add("pieces.pvti", pieces, "", {{"left.vti", left}, {"right.vti", right}});
    add("right.vti", right, "pieces.pvti", {{"left.vti", left}, {"pieces.pvti", pieces}});
    add("moments.pvd", moments, "", {{"left.vti", left}, {"right.vti", right}, {"pieces.pvti", pieces}});
}

void add_vtk(std::vector<Seed>& all) {
    Vti packed, numbers;
    packed.format = "binary", packed.compressor = "vtkZLibDataCompressor";
    packed.compress = [](const std::string& bytes) { return deflated(bytes, 15); };
    numbers.format = "ascii",
    numbers.arrays[0].values = "1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24";
    all.push_back({.name = "appended.vti", .bytes = Vti().bytes(), .is_text = true});
    all.push_back({.name = "packed.vti", .bytes = packed.bytes(), .is_text = true});
    all.push_back({.name = "numbers.vti", .bytes = numbers.bytes(), .is_text = true});
    all.push_back({.name = "binary.vtk", .bytes = vtk_file(), .is_text = true});
    all.push_back(
        {.name = "numbers.vtk",
         .bytes = vtk_start(false) + "POINT_DATA 24\n" +
                  vtk_scalars("float", "1 2 3 4 5 6\n7 8 9 10 11 12\n-1 -2 -3 -4 -5 -6\n.5 1e3 17 18 19 250\n"),
         .is_text = true});
}

/// Three pages of 4 x 3 bytes whose pixels come before the pages' tables: it may end within a link to the next one.
std::string tiff_with_links_behind() {
    constexpr std::size_t pages = 3, pixels = 12;
    const auto u16 = [](std::size_t value) { return bytes_of(std::uint16_t(value)); };
    const auto u32 = [](std::size_t value) { return bytes_of(std::uint32_t(value)); };
    std::string file = "II" + u16(42) + u32(8 + pages * pixels) + std::string("abcdefghijklmnopqrstuvwxyz0123456789");
    for (std::size_t page = 0; page < pages; ++page) {
        file += u16(9);
        for (const auto& [tag, value] :
             std::initializer_list<std::pair<std::size_t, std::size_t>>{{256, 4},
                                                                        {257, 3},
                                                                        {258, 8},
                                                                        {259, 1},
                                                                        {262, 1},
                                                                        {273, 8 + page * pixels},
                                                                        {277, 1},
                                                                        {278, 3},
                                                                        {279, pixels}})
            file += u16(tag) + u16(4) + u32(1) + u32(value);
        file += u32(page + 1 < pages ? file.size() + 4 : 0);
    }
    return file;
}

void add_tiff(std::vector<Seed>& all) {
    TiffImage described;
    described.description = "ImageJ=1.53\nimages=2\nslices=2\nspacing=2.5\nunit=mm\n";
    described.x_resolution = described.y_resolution = 4;
    all.push_back({.name = "pages.tif", .bytes = tiff_file({described, TiffImage()})});
    all.push_back({.name = "big.tif", .bytes = tiff_file({TiffImage(), TiffImage()}, true)});
    all.push_back({.name = "links-behind.tif", .bytes = tiff_with_links_behind()});
    all.push_back({.name = "s2.tif",
                   .bytes = tiff_file({TiffImage()}),
                   .beside = {{"s1.tif", tiff_file({TiffImage()})}},
                   .opened = "."});
    all.push_back({.name = "c1.tif", .bytes = ome_file(), .beside = {{"c2.tif", tiff_file({TiffImage()})}}});
}

void add_raw(std::vector<Seed>& all) {
    all.push_back({.name = "voxels_4x3x2_uint8.raw", .bytes = std::string(24, 'v')});
    for (const std::string name : {"head_4x3x2_uint8.raw", "a.b-2x3x2_uint16.raw", "CT_2x1x3_float_v2.raw"})
        all.push_back({.name = name, .kind = Kind::raw_name, .bytes = name, .is_text = true, .is_open_ended = true});
}

/// Radiance: 9 x 3, run-length coded and plain.
void add_probes(std::vector<Seed>& all) {
    const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=1.0\n\n-Y 3 +X 9\n";
    std::string coded, plain;
    for (int row = 0; row < 3; ++row) {
        coded += std::string("\x02\x02\x00\x09", 4);
        for (int component = 0; component < 4; ++component)
            coded += std::string("\x83", 1) + char(100 + row) + std::string("\x06", 1) + "abcdef";
        for (int x = 0; x < 9; ++x) plain += std::string({char(40 + x), char(80 + row), char(90), char(129)});
    }
    all.push_back({.name = "coded.hdr", .kind = Kind::probe, .bytes = header + coded, .is_text = true});
    all.push_back({.name = "plain.hdr", .kind = Kind::probe, .bytes = header + plain, .is_text = true});
    Frame frame(12, 6);
    for (std::size_t i = 0; i < frame.rgba.size(); ++i) frame.rgba[i] = float(i % 7) / 4;
    all.push_back(
        {.name = "probe.exr", .kind = Kind::probe, .bytes = text(encode_exr(frame, {{"note", "made for tests"}}))});
}

std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | std::uint8_t(bytes[at + i]);
    return value;
}

/// Every chunk of a PNG: length, name, data, checksum of name and data.
std::string with_png_checksums(std::string png) {
    for (std::size_t at = 8; at + 12 <= png.size();) {
        const std::size_t length = big_endian(png, at);
        if (length > png.size() - at - 12) break;
        const auto* covered = reinterpret_cast<const Bytef*>(png.data() + at + 4);
        png.replace(at + 8 + length, 4, bytes_of(std::uint32_t(crc32(0, covered, uInt(length + 4))), true));
        at += length + 12;
    }
    return png;
}

const char* const scene_text = R"({"chiaro": 1, "volume": {"file": "sample:ball:16"}, "image": {"size": [64, 48]},
 "transfer_function": {"opacity_unit_distance": 1.5, "points": [{"value": 25, "rgb": [0.2, 0.8, 0.3], "opacity": 0.04},
  {"value": 200, "rgb": [1, 1, 1], "opacity": 0.9}]},
 "camera": {"model": "orbit", "azimuth_deg": 35, "elevation_deg": 25, "up": [0, 0, 1], "fit_scale": 0.62},
 "lighting": {"method": "spao", "levels": 5, "strength": 0.5}, "probe": {"preset": "sky", "rotation": 30},
 "mode": "iso", "iso": [{"value": 100, "color": "tomato", "opacity": 0.5}], "clip": {"box": [0, 1, 0, 0.5, 0, 1]},
 "window": [100, 50], "sampling": {"step": 0.5}, "background": [0, 0, 0.25], "output": {"tone": "aces", "exposure": 1}})";

void add_scenes(std::vector<Seed>& all) {
    all.push_back({.name = "scene.json", .kind = Kind::scene, .bytes = scene_text, .is_text = true});
    Image image{8, 6, true, std::vector<std::uint8_t>(192)};
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = std::uint8_t(37 * i);
    const auto metadata_of = [](const std::string& scene) { return Metadata{{"Title", "π"}, {"chiaro", scene}}; };
    const Metadata metadata = metadata_of(scene_text);
    all.push_back({.name = "scene.png",
                   .kind = Kind::scene,
                   .bytes = text(encode_png(image, metadata)),
                   .repair = with_png_checksums,
                   .needs_end = true});
    all.push_back({.name = "scene.exr",
                   .kind = Kind::scene,
                   .bytes = text(encode_exr(Frame(8, 6), metadata)),
                   .needs_end = true});
    all.push_back({.name = "inside.png",
                   .kind = Kind::scene,
                   .bytes = scene_text,
                   .packed = [=](const std::string& scene) { return text(encode_png(image, metadata_of(scene))); },
                   .is_text = true});
    all.push_back(
        {.name = "inside.exr",
         .kind = Kind::scene,
         .bytes = scene_text,
         .packed = [=](const std::string& scene) { return text(encode_exr(Frame(8, 6), metadata_of(scene))); },
         .is_text = true});
}

void add_transfer_functions(std::vector<Seed>& all) {
    all.push_back(
        {.name = "points.json",
         .kind = Kind::transfer,
         .bytes =
             R"({"name": "two", "opacity_unit_mm": 2.5, "rgb_space": "linear", "points": [)"
             R"({"value": -100, "rgb": [0, 0.5, 1], "opacity": 0}, {"value": 300.5, "rgb": [1, 1, 1], "opacity": 1}]})",
         .is_text = true});
    all.push_back(
        {.name = "preset.json", .kind = Kind::transfer, .bytes = R"({"preset": "ct-bone"})", .is_text = true});
}

/// Those of ParaView, 3D Slicer, Inviwo and Voreen.
void add_foreign_functions(std::vector<Seed>& all) {
    const auto add = [&](const char* name, const std::string& bytes) {
        all.push_back({.name = name, .kind = Kind::transfer, .bytes = bytes, .is_text = true});
    };
    add("map.paraview.json",
        R"([{"Name": "a", "ColorSpace": "Lab", "RGBPoints": [0, 0.2, 0.3, 0.7, 9, 0.7, 0, 0.1,],)"
        R"( "Points": [0, 0, 0.3, 0.4, 9, 1, 0.5, 0]}, {"Name": "b", "ColorSpace": "HSV", "RGBPoints": [0, 1, 0, 0, 1, 0, 0, 1]}])");
    add("lines.vp", "1\n1\n0.9\n0.1\n0.2\n10\n6 -1000 0 40 0.2 300 0.6\n4 0 1 255 0.5\n8 -1000 0 0 0 300 1 1 0.5\n");
    add("property.vp.json",
        R"({"volumeProperties": [{"components": [{"rgbTransferFunction": {"points": [{"x": 1, "color": [0, 1, 0]},)"
        R"( {"x": 5, "color": [1, 1, 0]}]}, "scalarOpacity": {"points": [{"x": 2, "y": 1}, {"x": 3, "y": 0.5}]}}]}]})");
    add("workspace.itf",
        "<?xml version=\"1.0\" ?>\n<InviwoWorkspace version=\"2\">\n<maskMin content=\"0.2\" />\n<Points>\n"
        "<Point><pos content=\"0.1\" /><rgba x=\"1\" y=\"0.5\" z=\"0\" w=\"0.2\" /></Point>\n"
        "<Point><pos content=\"0.9\" /><rgba x=\"0\" y=\"0.5\" z=\"1\" w=\"1\" "
        "/></Point>\n</Points>\n</InviwoWorkspace>\n");
    add("function.tfi",
        "<?xml version=\"1.0\" ?>\n<VoreenData version=\"1\">\n<TransFuncIntensity>\n<domain x=\"-100\" y=\"300\" />"
        "<gammaValue value=\"2\" />\n<Keys>\n"
        "<key type=\"TransFuncMappingKey\"><intensity value=\"0.25\" /><split value=\"false\" />"
        "<colorL r=\"255\" g=\"0\" b=\"9\" a=\"51\" /></key>\n"
        "<key type=\"TransFuncMappingKey\"><intensity value=\"0.75\" /><split value=\"true\" />"
        "<colorL r=\"0\" g=\"0\" b=\"0\" a=\"255\" /><colorR r=\"1\" g=\"2\" b=\"3\" a=\"4\" /></key>\n"
        "</Keys></TransFuncIntensity></VoreenData>\n");
}

void add_emission(std::vector<Seed>& all) {
    all.push_back({.name = "glow.txt",
                   .kind = Kind::emission,
                   .bytes = "# value strength\n10 1\n100 20.5\n# hot\n200 1e3\n",
                   .is_text = true,
                   .is_open_ended = true});
}

std::string with_checksum(std::string bytes) {
    if (bytes.size() < 8) return bytes;
    const std::uint64_t sum = hash_of(std::string_view(bytes).substr(0, bytes.size() - 8));
    return bytes.replace(bytes.size() - 8, 8, bytes_of(sum));
}

void add_cache(std::vector<Seed>& all) {
    const Folder folder;
    const HistogramCache cache(folder.name(), cached_volume().data(), {});
    LocalHistograms h;
    h.nodes = {3, 2, 2}, h.codewords = 2, h.stride = 16;
    h.identifiers = VoxelBuffer((h.node_count() + 1) * sizeof(CodewordPair));
    std::fill_n(h.identifiers.data(), h.identifiers.size(), std::byte(0));
    h.pairs()[5].forward = 1;
    h.shares.assign(32, 1000), h.scale = {0.5F, 2};
    std::vector<std::string> notes;
    cache.write(h, notes);
    all.push_back({.name = cache.path().filename(),
                   .kind = Kind::cache,
                   .bytes = content_of(cache.path()),
                   .repair = with_checksum});
}

std::vector<Seed> made() {
    constexpr std::pair<const char*, void (*)(std::vector<Seed>&)> formats[] = {{"nrrd", add_nrrd},
                                                                                {"meta", add_meta},
                                                                                {"nifti", add_nifti},
                                                                                {"dicom", add_dicom},
                                                                                {"vtk", add_vtk},
                                                                                {"vtk", add_named_vtk},
                                                                                {"tiff", add_tiff},
                                                                                {"hdf5", add_hdf5},
                                                                                {"zarr", add_zarr},
                                                                                {"vdb", add_vdb},
                                                                                {"raw", add_raw},
                                                                                {"probe", add_probes},
                                                                                {"scene", add_scenes},
                                                                                {"transfer", add_transfer_functions},
                                                                                {"transfer", add_foreign_functions},
                                                                                {"glow", add_emission},
                                                                                {"cache", add_cache}};
    std::vector<Seed> all;
    for (const auto& [format, add] : formats) {
        const std::size_t before = all.size();
        add(all);
        for (std::size_t i = before; i < all.size(); ++i) all[i].format = format;
    }
    return all;
}

}  // namespace

const DeviceVolume& cached_volume() {
    static const DeviceVolume volume = upload(Device::cpu(1), make_sample("ball", 8));
    return volume;
}

const std::vector<Seed>& seeds() {
    static const std::vector<Seed> all = made();
    return all;
}

}  // namespace hostile
