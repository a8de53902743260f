// Everything that a volume can be read from, in the order in which it is tried.
#include "core/did_you_mean.h"
#include "core/text.h"
#include "core/threads.h"
#include "io/chunk_source.h"
#include "io/fetcher.h"
#include "io/file_source.h"
#include "io/helper.h"
#include "io/moment_files.h"
#include "io/raw.h"
#include "io/sample_name.h"
#include "io/standard_input.h"

#include <chiaro/brick_source.h>
#include <chiaro/error.h>
#include <chiaro/io.h>
#include <chiaro/samples.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <cmath>
#include <fstream>
#include <functional>

namespace chiaro {

namespace fs = std::filesystem;

namespace {

/// By what each version puts into the folder of an array or a group.
bool is_zarr_folder(const std::string& folder) {
    std::error_code error;
    return std::ranges::any_of(std::array{"zarr.json", ".zarray", ".zgroup", ".zattrs"},
                               [&](const char* name) { return fs::is_regular_file(fs::path(folder) / name, error); });
}

}  // namespace

std::pair<std::string, std::string> split_volume_name(const std::string& name) {
    if (wire::is_url(name)) {
        const auto at = std::min(name.find('#'), name.size());
        return {name.substr(0, at), at + 1 < name.size() ? "/" + name.substr(at + 1) : ""};
    }
    std::error_code error;
    if (fs::exists(name, error)) return {name, ""};
    for (const std::string mark : {":/", "#"})
        for (const auto at : {name.find(mark), name.rfind(mark)}) {
            if (at == std::string::npos) continue;
            const std::string file = name.substr(0, at), part = name.substr(at + 1);
            if (fs::is_regular_file(file, error) || is_zarr_folder(file))
                return {file, part.starts_with('/') ? part : "/" + part};
        }
    return {name, ""};
}

std::pair<std::string, int> split_sample_name(const std::string& name) {
    const std::string rest = name.substr(7), text = rest.substr(std::min(rest.find(':'), rest.size()));
    int size = 0;
    if (!text.empty()) {
        const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), size);
        if (error != std::errc{} || end != text.data() + text.size() || size <= 0)
            throw Error(ErrorCode::usage, "'" + name + "' is not sample:NAME or sample:NAME:SIZE");
    }
    return {rest.substr(0, rest.size() - text.size()), size};
}

namespace {

/// What is known of a name before anything is decoded.
struct Candidate {
    std::string name, lower_name;
    std::string part;  ///< what follows a file's name as `file.h5:/part`
    bool is_file = false, is_folder = false;
    std::string beginning;  ///< the first bytes of a file
    bool raw_stated = false;

    bool ends_with(std::initializer_list<std::string_view> endings) const {
        return std::any_of(endings.begin(), endings.end(), [&](auto e) { return lower_name.ends_with(e); });
    }
    bool has_at(std::size_t position, std::string_view magic) const {
        return beginning.size() >= position && std::string_view(beginning).substr(position).starts_with(magic);
    }
};

struct Reader {
    FormatInfo info;
    std::function<bool(const Candidate&)> accepts;
    std::function<Volume(const Candidate&, const ReadOptions&, Progress&)> read;
};

std::string lower(std::string text) {
    for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

/// A folder of pictures rather than of DICOM files: as many TIFF files as others.
bool is_tiff_folder(const std::string& folder) {
    std::size_t images = 0, others = 0;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        const std::string ending = lower(entry.path().extension().string());
        const bool image = ending == ".tif" || ending == ".tiff";
        images += image;
        others += !image && entry.is_regular_file(error);
    }
    return images > 0 && images >= others;
}

Candidate examine(const std::string& stated_name, const ReadOptions& options) {
    const auto [name, part] = split_volume_name(stated_name);
    Candidate candidate{.name = name,
                        .lower_name = lower(name),
                        .part = part,
                        .beginning = {},
                        .raw_stated = options.raw.dimensions.has_value()};
    if (name == "-" || name.starts_with("sample:")) return candidate;
    if (wire::is_url(name)) {
        candidate.name = checked_url(name);
        return candidate;
    }
    std::error_code error;
    const auto status = fs::status(name, error);
    candidate.is_folder = fs::is_directory(status);
    candidate.is_file = fs::is_regular_file(status);
    if (!fs::exists(status))
        throw Error(ErrorCode::input,
                    "cannot read '" + one_line(name) + "': there is no such file or folder" + did_you_mean_file(name));
    if (!candidate.is_file && !candidate.is_folder)
        throw Error(ErrorCode::input,
                    "cannot read '" + one_line(name) + "': it is neither a regular file nor a folder");
    if (candidate.is_folder && candidate.ends_with({".zarr"}) && !is_zarr_folder(name))
        throw Error(ErrorCode::input, "cannot read '" + one_line(name) +
                                          "': an OME-Zarr without its description, which is written last; what made it "
                                          "may have been interrupted (chiaro convert goes on where it was)");
    if (!candidate.is_file) return candidate;
    std::ifstream file(name, std::ios::binary);
    if (!file) throw Error(ErrorCode::input, "cannot read '" + one_line(name) + "': it cannot be opened");
    candidate.beginning.resize(352);
    file.read(candidate.beginning.data(), 352);
    candidate.beginning.resize(std::size_t(file.gcount()));
    if (candidate.beginning.empty()) throw Error(ErrorCode::input, "cannot read '" + one_line(name) + "': it is empty");
    return candidate;
}

Volume read_sample(const Candidate& candidate, const ReadOptions&, Progress& progress) {
    const auto [name, size] = split_sample_name(candidate.name);
    return make_sample(name, size, progress);
}

Volume read_standard_input(const Candidate&, const ReadOptions& options, Progress& progress) {
    const Descriptor spooled = spool_standard_input(options, progress);
    return decode_isolated({"nrrd", "/proc/self/fd/0", "standard input", "", spooled.number()}, options, progress);
}

auto decoded_as(const std::string& format) {
    return [format](const Candidate& candidate, const ReadOptions& options, Progress& progress) {
        const std::string& part = format == "dicom" ? options.series : candidate.part;
        return decode_isolated({format, candidate.name, candidate.name, part, -1, options.private_addresses}, options,
                               progress);
    };
}

std::vector<Reader> readers() {
    return {
        {{"sample", "sample:NAME", "generated"}, [](auto& c) { return c.name.starts_with("sample:"); }, read_sample},
        {{"standard input", "-", "NRRD with its data inside"},
         [](auto& c) { return c.name == "-"; },
         read_standard_input},
        {{"OME-Zarr", "folder, http:// https://",
          "versions 0.4 and 0.5, or one Zarr array; store.zarr#path for another image, store.zarr#path@n for a "
          "channel"},
         [](auto& c) { return wire::is_url(c.name) || (c.is_folder && is_zarr_folder(c.name)); },
         decoded_as("zarr")},
        {{"TIFF", "folder, .tif .tiff", "slices in the order of their names, or one file of several pages"},
         [](auto& c) {
             return (c.is_folder && is_tiff_folder(c.name)) || c.ends_with({".tif", ".tiff"}) ||
                    c.has_at(0, std::string_view("II*\0", 4)) || c.has_at(0, std::string_view("MM\0*", 4));
         },
         decoded_as("tiff")},
        {{"DICOM", "folder, .dcm", "a folder with one or more series, or one file"},
         [](auto& c) { return c.is_folder || c.has_at(128, "DICM") || c.ends_with({".dcm"}); },
         decoded_as("dicom")},
        {{"raw", ".raw", "with --raw-size and --raw-type, or name_64x64x64_uint8.raw"},
         [](auto& c) { return c.raw_stated; },
         [](auto& c, auto& options, auto& progress) { return read_raw(c.name, options, progress); }},
        {{"NRRD", ".nrrd .nhdr", "raw, gzip, ascii; attached or detached"},
         [](auto& c) {
             return c.ends_with({".nrrd", ".nhdr"}) || c.has_at(0, "NRRD000");
         },
         decoded_as("nrrd")},
        {{"MetaImage", ".mha .mhd", "raw, compressed, ascii"},
         [](auto& c) {
             return c.ends_with({".mha", ".mhd"});
         },
         decoded_as("meta")},
        {{"NIfTI", ".nii .nii.gz .hdr", "NIfTI-1 and NIfTI-2"},
         [](auto& c) {
             return c.ends_with({".nii", ".nii.gz", ".hdr", ".hdr.gz"}) || c.has_at(344, "n+1") ||
                    c.has_at(344, "ni1") || c.has_at(4, "n+2");
         },
         decoded_as("nifti")},
        {{"VTK XML", ".vti .pvti .pvd", "image data, in pieces, moments: ascii, base64 or appended; zlib, LZ4, LZMA"},
         [](auto& c) {
             return c.ends_with({".vti", ".pvti", ".pvd"}) ||
                    (c.has_at(0, "<") && c.beginning.find("<VTKFile") != std::string::npos);
         },
         decoded_as("vti")},
        {{"VTK", ".vtk", "legacy structured points: ascii, binary"},
         [](auto& c) { return c.ends_with({".vtk"}) || c.has_at(0, "# vtk DataFile"); },
         decoded_as("vtk")},
        {{"HDF5", ".h5 .hdf5 .hdf .vtkhdf",
          "file.h5:/path/to/dataset or file.h5#path; without a path VTK's image data, or the only dataset of three "
          "dimensions"},
         [](auto& c) {
             return c.ends_with({".h5", ".hdf5", ".hdf", ".vtkhdf"}) || c.has_at(0, "\x89HDF\r\n\x1a\n");
         },
         decoded_as("hdf5")},
        {{"OpenVDB", ".vdb", "grids of floats or doubles; file.vdb#name for another than the first"},
         [](auto& c) { return c.ends_with({".vdb"}) || c.has_at(0, " BDV"); },
         decoded_as("vdb")},
    };
}

/// Whether a name may go on behind the file's with that of a part.
bool has_parts(const Reader& reader) {
    return std::ranges::any_of(std::array{"HDF5", "OME-Zarr", "OpenVDB"},
                               [&](const char* name) { return reader.info.name == name; });
}

/// Raw is listed once but tried twice: before the others where its layout is stated, after them by its name alone.
const Reader* find_reader(const std::vector<Reader>& all, const Candidate& candidate) {
    for (const auto& reader : all)
        if (reader.accepts(candidate)) return &reader;
    const auto layout = completed_layout({}, fs::path(candidate.name).filename().string());
    const bool raw = candidate.ends_with({".raw"}) || (layout.dimensions && layout.type);
    return raw ? &*std::find_if(all.begin(), all.end(), [](auto& r) { return r.info.name == "raw"; }) : nullptr;
}

std::uint64_t count_nonfinite(const Volume& volume) {
    std::atomic<std::uint64_t> sum{0};
    const auto count = [&]<class T>(std::span<const T> values) {
        parallel_for(std::int64_t(values.size()), 1 << 20, [&, values](std::int64_t first, std::int64_t last) {
            std::uint64_t part = 0;
            for (auto i = first; i < last; ++i) part += !std::isfinite(values[std::size_t(i)]);
            sum += part;
        });
    };
    if (volume.type == VoxelType::f32) count(volume.as<float>());
    if (volume.type == VoxelType::f64) count(volume.as<double>());
    return sum;
}

/// What one should know of the moments beside the one that is read.
void tell_moments(const ReadOptions& options, Volume& volume) {
    const auto& [count, shown, times, unit] = volume.moments;
    if (shown != options.time)
        throw Error(ErrorCode::input, fmt::format("cannot read '{}': it holds one moment in time, so there is none of "
                                                  "number {}",
                                                  one_line(volume.source), options.time));
    if (count > 1 && shown == 0)
        volume.notes.push_back(
            fmt::format("holds {} moments in time; the first is shown (--time N shows another, 0 to "
                        "{}; -o NAME-{{t:03}}.png draws all)",
                        count, count - 1));
}

/// Unless the options say it, colours are what a file says are some, and three or four bytes of which none says what
/// they are.
void tell_colors(const ReadOptions& options, Volume& volume) {
    const bool can_be = volume.components == 3 || volume.components == 4;
    if (options.components_as == ComponentsAs::rgb && !can_be)
        throw Error(ErrorCode::input,
                    fmt::format("cannot read '{}' in its own colours: it has {} value{} a voxel, not "
                                "three or four (--channels-as channels)",
                                one_line(volume.source), volume.components, volume.components > 1 ? "s" : ""));
    if (options.components_as == ComponentsAs::rgb) volume.has_own_colors = true;
    if (options.components_as == ComponentsAs::channels) volume.has_own_colors = false;
    if (volume.has_own_colors)
        volume.notes.push_back(fmt::format(
            "is shown in its own colours, its opacity by {} (--channels-as channels shows its values as channels)",
            volume.components == 4 ? "alpha" : "luminance"));
}

}  // namespace

Volume read_volume(const std::string& name, const ReadOptions& options, Progress& progress) {
    if (options.time < 0)
        throw Error(ErrorCode::usage, fmt::format("time {}: moments are counted from 0", options.time));
    if (is_moment_pattern(name)) {
        Volume volume =
            read_moment_file(name, options, [&](auto& file, auto& one) { return read_volume(file, one, progress); });
        volume.source = name;
        tell_moments(options, volume);
        return volume;
    }
    if (options.rescale && options.rescale->first == 0)
        throw Error(ErrorCode::usage, "rescale: a slope of 0 would leave nothing of the volume");
    progress.report("read", 0);
    const auto all = readers();
    const Candidate candidate = examine(name, options);
    const Reader* reader = find_reader(all, candidate);
    if (!reader) {
        std::string known;
        for (const auto& format : list_formats()) known += (known.empty() ? "" : ", ") + format.name;
        throw Error(ErrorCode::input, "cannot read '" + one_line(name) + "': it is none of " + known);
    }
    if (!candidate.part.empty() && !has_parts(*reader))
        throw Error(ErrorCode::input, "cannot read '" + name +
                                          "': only HDF5 files and Zarr stores hold datasets with a path, and only "
                                          "OpenVDB files grids with a name");
    Volume volume = reader->read(candidate, options, progress);
    volume.source = name;
    if (options.rescale && volume.slope == 1 && volume.intercept == 0)
        std::tie(volume.slope, volume.intercept) = *options.rescale;
    tell_moments(options, volume);
    tell_colors(options, volume);
    if (const auto n = count_nonfinite(volume); n > 0)
        volume.notes.push_back(fmt::format("{} voxels are not finite", n));
    progress.report("read", 1);
    return volume;
}

std::shared_ptr<const BrickSource> open_brick_source(const std::string& name, const ReadOptions& options) {
    if (is_sample_name(name) && options.time == 0) {
        const auto [sample, size] = split_sample_name(name);
        return open_sample(sample, size);
    }
    const auto all = readers();
    const Candidate candidate = examine(name, options);
    const Reader* reader = find_reader(all, candidate);
    const auto finish = [&](Volume& header) {
        header.source = name;
        if (options.rescale && header.slope == 1 && header.intercept == 0)
            std::tie(header.slope, header.intercept) = *options.rescale;
    };
    if (reader && reader->info.name == "raw" && options.time == 0) {
        RawFile raw = examine_raw(candidate.name, options);
        finish(raw.volume);
        return open_file_source(raw.volume, {candidate.name, raw.layout.offset, raw.layout.big_endian});
    }
    struct Way {
        std::string_view name;
        const char* format;
        bool is_chunked;  ///< decoded chunk by chunk; else the voxels lie as they are
    };
    constexpr Way ways[] = {{"NRRD", "nrrd", false}, {"MetaImage", "meta", false}, {"NIfTI", "nifti", false},
                            {"VTK", "vtk", false},   {"HDF5", "hdf5", true},       {"OME-Zarr", "zarr", true},
                            {"TIFF", "tiff", true},  {"OpenVDB", "vdb", true}};
    const auto way = std::ranges::find_if(ways, [&](const Way& w) { return reader && reader->info.name == w.name; });
    if (way == std::end(ways) || (options.time > 0 && !way->is_chunked)) return {};
    const DecodeRequest request{way->format, candidate.name,           candidate.name, candidate.part,
                                -1,          options.private_addresses};
    try {
        if (way->is_chunked) return open_chunk_source(request, options, finish);
        Progress progress;
        auto [header, place] = locate_isolated(request, options, progress);
        finish(header);
        return open_file_source(header, place);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::input) throw;
        return {};  // read_volume says why, or reads it
    }
}

std::vector<FormatInfo> list_formats() {
    std::vector<FormatInfo> formats;
    for (const auto& reader : readers()) formats.push_back(reader.info);
    return formats;
}

}  // namespace chiaro
