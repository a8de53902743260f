// TIFF: libtiff decodes the pages; which of them make a volume, and their place, is decided here.
#include "decode/byte_source.h"
#include "decode/payload.h"
#include "decode/readers.h"
#include "decode/text.h"
#include "decode/tiff_layout.h"
#include "decode/tiff_page.h"
#include "volume/validate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>

namespace chiaro::decode {
namespace {

using Path = std::filesystem::path;

struct Slice {
    Path path;
    std::uint64_t directory = 0;  ///< where the page's directory lies in the file
    TiffPage page;
};

/// Runs of digits compare as numbers: slice2 comes before slice10.
bool before_naturally(const std::string& a, const std::string& b) {
    const auto digit = [](char c) { return c >= '0' && c <= '9'; };
    std::size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        if (!digit(a[i]) || !digit(b[j])) {
            if (a[i] != b[j]) return a[i] < b[j];
            ++i, ++j;
            continue;
        }
        const auto number_at = [&](const std::string& text, std::size_t& at) {
            while (at < text.size() && text[at] == '0') ++at;
            const std::size_t first = at;
            while (at < text.size() && digit(text[at])) ++at;
            return text.substr(first, at - first);
        };
        const std::string m = number_at(a, i), n = number_at(b, j);
        if (m.size() != n.size()) return m.size() < n.size();
        if (m != n) return m < n;
    }
    return a.size() - i < b.size() - j || (a.size() - i == b.size() - j && a < b);
}

std::vector<Path> slices_in(const Path& folder) {
    std::vector<Path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const std::string ending = lower(entry.path().extension().string());
        if (entry.is_regular_file() && (ending == ".tif" || ending == ".tiff")) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end(),
              [](auto& a, auto& b) { return before_naturally(a.filename().string(), b.filename().string()); });
    return files;
}

/// To libtiff a file that was cut in the link to its next page ends there.
void check_last_link(const Path& path, TIFF* file, std::uint64_t size) {
    const bool big = TIFFIsBigTIFF(file);
    const auto number_at = [&](std::uint64_t offset, std::size_t bytes) {
        if (offset > size || bytes > size - offset) refuse("is cut in the link to its next page");
        std::array<std::byte, 8> stored{};
        open_plain(path, offset)->read(std::span(stored).first(bytes));
        std::uint64_t number = 0;
        for (std::size_t i = 0; i < bytes; ++i)
            number |= std::uint64_t(stored[TIFFIsBigEndian(file) ? bytes - 1 - i : i]) << 8 * i;
        return number;
    };
    const std::uint64_t directory = TIFFCurrentDirOffset(file), count_bytes = big ? 8 : 2;
    const std::uint64_t entries = number_at(directory, count_bytes);
    if (entries > size) refuse("is cut in the link to its next page");
    number_at(directory + count_bytes + entries * (big ? 20 : 12), big ? 8 : 4);
}

/// The full pages of a file; thumbnails and masks are no slices.
std::vector<Slice> pages_of(const Path& path, bool first_only, Output& output) {
    const auto size = regular_file_size(path);
    const TiffFile file = open_tiff(path);
    std::vector<Slice> pages;
    for (bool more = true; more;) {
        std::uint32_t kind = 0;
        TIFFGetFieldDefaulted(file.get(), TIFFTAG_SUBFILETYPE, &kind);
        if ((kind & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK)) == 0)
            pages.push_back({path, TIFFCurrentDirOffset(file.get()), scan_page(file.get(), size)});
        if (pages.size() > 4 * 65535) refuse("has more than 262140 pages");
        output.progress(0.1);
        more = !(first_only && !pages.empty());
        if (more && TIFFLastDirectory(file.get())) check_last_link(path, file.get(), size), more = false;
        if (more) next_page(file.get());
    }
    if (pages.empty()) refuse("has no page that is a whole picture");
    return pages;
}

std::vector<Slice> slices_of(const Path& path, Volume& volume, Output& output) {
    if (!std::filesystem::is_directory(path)) return pages_of(path, false, output);
    const auto files = slices_in(path);
    if (files.size() == 1) return pages_of(files[0], false, output);
    std::vector<Slice> slices;
    for (const auto& file : files) {
        output.at(file.filename().string());
        try {
            slices.push_back(pages_of(file, true, output)[0]);
        } catch (const Error& error) {
            refuse(fmt::format("'{}' {}", file.filename().string(), error.what()));
        }
    }
    if (slices.empty()) refuse("the folder holds no TIFF file");
    volume.key_values["first file"] = files.front().filename().string();
    volume.key_values["last file"] = files.back().filename().string();
    return slices;
}

/// The pages of the files that a description names, in its order; `slices` where they all lie in one or are not all
/// there, which is told.
std::vector<Slice> planes_in_files(std::vector<Slice> slices, const TiffLayout& layout, Volume& volume,
                                   Output& output) {
    std::map<std::string, std::vector<Slice>> files;
    for (const TiffPlane& plane : layout.planes) files[plane.file];
    const Path& told_in = slices[0].path;
    if (files.size() < 2) return slices;
    for (auto& [name, pages] : files) {
        const Path file = confined(told_in, name);
        if (!std::filesystem::is_regular_file(file)) {
            volume.notes.push_back(fmt::format(
                "its description names pages in {} files, of which '{}' is not there; the others are left out",
                files.size(), name));
            return slices;
        }
        output.at(name);
        try {
            pages = pages_of(file, false, output);
        } catch (const Error& error) {
            refuse(fmt::format("'{}' {}", name, error.what()));
        }
    }
    std::vector<Slice> planes(std::size_t(layout.images()));
    for (const TiffPlane& plane : layout.planes) {
        const auto& pages = files[plane.file];
        if (plane.page >= pages.size())
            refuse(fmt::format("names page {} of '{}', which has {}", plane.page, plane.file, pages.size()));
        planes[plane.place] = pages[plane.page];
    }
    const auto missing = std::ranges::count_if(planes, [](const Slice& s) { return s.path.empty(); });
    if (missing > 0)
        refuse(fmt::format("its description says where {} of {} pages lie", planes.size() - std::size_t(missing),
                           planes.size()));
    volume.key_values["files"] = std::to_string(files.size());
    return planes;
}

/// Keeps the kind of which there are most, and names what is left out.
void keep_one_kind(std::vector<Slice>& slices, Volume& volume) {
    const auto count = [&](const Slice& like) {
        return std::count_if(slices.begin(), slices.end(), [&](auto& s) { return s.page.same_kind(like.page); });
    };
    std::vector<Slice> kinds;  // one of each
    for (const auto& slice : slices)
        if (std::none_of(kinds.begin(), kinds.end(), [&](auto& k) { return k.page.same_kind(slice.page); }))
            kinds.push_back(slice);
    if (kinds.size() == 1) return;
    const TiffPage kept =
        std::max_element(kinds.begin(), kinds.end(), [&](auto& a, auto& b) { return count(a) < count(b); })->page;
    std::string names;
    std::size_t left_out = 0;
    for (std::size_t i = 0; i < slices.size(); ++i) {
        if (slices[i].page.same_kind(kept)) continue;
        const bool in_folder = slices.front().path != slices.back().path;
        if (++left_out <= 5)
            names += (names.empty() ? "" : ", ") +
                     (in_folder ? slices[i].path.filename().string() : fmt::format("page {}", i + 1));
    }
    std::erase_if(slices, [&](auto& s) { return !s.page.same_kind(kept); });
    volume.notes.push_back(fmt::format("{} pictures of another size or type than {} x {} {} are left out: {}{}",
                                       left_out, kept.columns, kept.rows, name_of(kept.type), names,
                                       left_out > 5 ? ", ..." : ""));
}

/// Spacing from the description, else from the resolution tags; slices as far apart as columns where nothing else is
/// stated. Files of slices carry no anatomy.
void set_spacing(const TiffPage& page, const TiffLayout& layout, Volume& volume) {
    const double unit = layout.unit_mm.value_or(page.unit_mm);
    Vec3& spacing = volume.geometry.spacing_mm;
    bool stated = true;
    if (layout.x_spacing_mm && layout.y_spacing_mm) {
        spacing.x = *layout.x_spacing_mm;
        spacing.y = *layout.y_spacing_mm;
    } else if (unit > 0 && page.x_resolution > 0) {
        spacing.x = unit / page.x_resolution;
        spacing.y = unit / page.y_resolution;
    } else {
        stated = false;
        if (page.x_resolution > 0) spacing.y = page.x_resolution / page.y_resolution;  // the aspect of a pixel
        volume.notes.push_back("the size of a pixel is not stated; 1 mm is taken");
    }
    spacing.z = layout.z_spacing_mm.value_or(spacing.x);
    if (!layout.z_spacing_mm && stated && volume.dimensions[2] > 1)
        volume.notes.push_back("the distance between slices is not stated; that between columns is taken");
}

void note_guessed_sizes(const std::vector<Slice>& slices, Volume& volume) {
    const auto guessed = std::count_if(slices.begin(), slices.end(), [](auto& s) { return s.page.are_sizes_guessed; });
    if (guessed > 0)
        volume.notes.push_back(
            fmt::format("{} of {} pages state wrong sizes of their strips, or none; those of their pixels are taken",
                        guessed, slices.size()));
}

void note_colors(const TiffPage& page, Volume& volume) {
    if (page.color == TiffColor::palette)
        volume.notes.push_back("pictures with a palette; the indices into it are the values");
    if (page.color == TiffColor::grey_from_white)
        volume.notes.push_back("values that grow from white to black; integers without sign were turned around");
    if (page.samples > page.values)
        volume.notes.push_back(fmt::format("{} values a pixel, of which the first {} taken", page.samples,
                                           page.values > 1 ? fmt::format("{} are", page.values) : "is"));
}

/// Large stacks of ImageJ have one directory, and all slices behind each other from its first strip on.
struct Run {
    std::uint64_t offset = 0;
    bool big_endian = false;
};
std::optional<Run> run_of(const Slice& first, const TiffLayout& layout, std::size_t pages) {
    const auto images = layout.images();
    if (pages != 1 || images == 1 || !first.page.description.starts_with("ImageJ=")) return {};
    const TiffFile file = open_tiff(first.path);
    std::uint16_t compression = COMPRESSION_NONE;
    TIFFGetFieldDefaulted(file.get(), TIFFTAG_COMPRESSION, &compression);
    if (compression != COMPRESSION_NONE || TIFFIsTiled(file.get()) || first.page.color != TiffColor::grey ||
        first.page.samples > 1)
        return {};
    const std::uint64_t offset = TIFFGetStrileOffset(file.get(), 0), size = regular_file_size(first.path);
    std::uint64_t needed = 0;
    if (__builtin_mul_overflow(first.page.bytes(), std::uint64_t(images), &needed)) refuse("states too many images");
    check_capacity(needed, size - std::min(size, offset));
    return Run{offset, TIFFIsBigEndian(file.get()) != 0};
}

/// Channels that lie in pages of their own, at the wanted time.
struct ChosenPages {
    std::vector<std::size_t> pages;  ///< indices, of each slice those of all channels
    int channels = 1;
};

ChosenPages choose_pages(const TiffLayout& layout, const TiffPage& page, std::size_t pages, bool is_run,
                         const Output& output, Volume& volume) {
    constexpr int max_values = 8;  // that can be shown
    const auto images = std::size_t(layout.images());
    ChosenPages chosen;
    if (layout.stated && (is_run || images == pages)) {
        const auto first = std::int64_t(output.choose_moment(std::uint64_t(layout.times), volume)) * layout.time_step;
        set_even_times(volume.moments, 0, layout.seconds, "s");
        const auto channels = std::min<std::int64_t>(layout.channels, std::max(max_values / page.values, 1));
        for (std::int64_t z = 0; z < layout.slices; ++z)
            for (std::int64_t c = 0; c < channels; ++c)
                chosen.pages.push_back(std::size_t(first + z * layout.slice_step + c * layout.channel_step));
        if (channels < layout.channels)
            volume.notes.push_back(fmt::format("holds {} channels; the first {} are taken", layout.channels, channels));
        chosen.channels = int(channels);
        return chosen;
    }
    if (layout.stated && images != pages)
        volume.notes.push_back(fmt::format(
            "its description states {} images, but there are {} pages, all taken as slices", images, pages));
    for (std::size_t i = 0; i < pages; ++i) chosen.pages.push_back(i);
    return chosen;
}

/// The values of a tag that libtiff does not know, where they are of this type.
template <class T>
std::span<const T> private_tag(TIFF* file, std::uint32_t name, TIFFDataType type) {
    const TIFFField* const field = TIFFFindField(file, name, TIFF_ANY);
    std::uint32_t count = 0;
    const T* values = nullptr;
    if (!field || TIFFFieldDataType(field) != type || TIFFFieldReadCount(field) != TIFF_VARIABLE2 ||
        !TIFFGetField(file, name, &count, &values) || !values)
        return {};
    return {values, count};
}

std::vector<ComponentInfo> colors_in_tags(const Path& path, std::uint64_t directory) {
    const TiffFile file = open_tiff(path);
    if (!TIFFSetSubDirectory(file.get(), directory)) return {};
    const auto counts = private_tag<std::uint32_t>(file.get(), 50838, TIFF_LONG);
    const auto bytes = private_tag<char>(file.get(), 50839, TIFF_BYTE);
    return imagej_colors(std::vector(counts.begin(), counts.end()), std::string(bytes.begin(), bytes.end()));
}

/// Names and colours of the channels; ImageJ's colours lie in tags of its own.
void set_infos(const Slice& first, const TiffLayout& layout, Volume& volume) {
    std::vector<ComponentInfo> infos = layout.channel_infos;
    if (first.page.description.starts_with("ImageJ=")) infos = colors_in_tags(first.path, first.directory);
    if (infos.empty() || volume.has_own_colors) return;
    infos.resize(std::size_t(volume.components));
    volume.component_infos = std::move(infos);
}

/// One value of each pixel, between those of other channels.
void fill_from_run(const Run& run, const Slice& first, std::size_t page, int channel, std::span<std::byte> to,
                   Volume& volume, Output& output) {
    const std::size_t size = first.page.bytes(), value = size_of(volume.type), count = size / value;
    std::vector<std::byte> plane(size);
    fill_from_bytes(*open_plain(first.path, run.offset + page * size), run.big_endian, volume.type, plane, output);
    for (std::size_t i = 0; i < count; ++i)
        std::copy_n(plane.data() + i * value, value,
                    to.data() + (i * std::size_t(volume.components) + std::size_t(channel)) * value);
}

void fill(const std::vector<Slice>& slices, const ChosenPages& chosen, const std::optional<Run>& run, Volume& volume,
          Output& output) {
    TiffFile file;
    const Path* opened = nullptr;
    const std::size_t size = slices[0].page.bytes() * std::size_t(volume.components);
    for (std::size_t i = 0; i < chosen.pages.size(); ++i) {
        const std::size_t z = i / std::size_t(chosen.channels), page = chosen.pages[i];
        const int channel = int(i % std::size_t(chosen.channels));
        const std::span<std::byte> to(volume.voxels.data() + z * size, size);
        output.progress(0.2 + 0.8 * double(i) / double(chosen.pages.size()));
        if (run) {
            fill_from_run(*run, slices[0], page, channel, to, volume, output);
            continue;
        }
        const Slice& slice = slices[page];
        output.at(slice.path.filename().string());
        if (!opened || *opened != slice.path) file = open_tiff(slice.path);
        opened = &slice.path;
        try {
            if (!TIFFSetSubDirectory(file.get(), slice.directory)) refuse("has a page that cannot be found again");
            const TiffPage found = scan_page(file.get(), regular_file_size(slice.path));
            if (!found.same_kind(slice.page)) refuse("has a page that changed while it was read");
            read_page(file.get(), found, to, channel * found.values, volume.components);
        } catch (const Error& error) {
            refuse(fmt::format("'{}' {}", slice.path.filename().string(), error.what()));
        }
    }
}

}  // namespace

Volume read_tiff(const Path& path, const std::string&, Output& output) {
    Volume volume;
    volume.format = "TIFF";
    auto slices = slices_of(path, volume, output);
    keep_one_kind(slices, volume);
    const bool is_stack = slices.front().path != slices.back().path;
    const TiffLayout layout =
        is_stack ? TiffLayout{}
                 : layout_from(slices[0].page.description, std::int64_t(slices.size()), slices[0].page.samples);
    if (!layout.planes.empty()) {
        slices = planes_in_files(std::move(slices), layout, volume, output);
        keep_one_kind(slices, volume);
    }
    const TiffPage& page = slices[0].page;
    if (!layout.metadata_file.empty())
        volume.notes.push_back("what its pages are is told in '" + layout.metadata_file + "', which is not read");
    const auto run = run_of(slices[0], layout, slices.size());
    const auto chosen = choose_pages(layout, page, slices.size(), run.has_value(), output, volume);
    const auto depth = std::int64_t(chosen.pages.size()) / chosen.channels;
    volume.type = page.type;
    volume.components = page.values * chosen.channels;
    volume.has_own_colors = page.color == TiffColor::rgb && chosen.channels == 1;
    checked_bytes({page.columns, page.rows, depth}, volume.components, volume.type);
    volume.dimensions = {page.columns, page.rows, int(depth)};
    set_infos(slices[0], layout, volume);
    volume.slope = layout.slope;
    volume.intercept = layout.intercept;
    set_spacing(page, layout, volume);
    note_guessed_sizes(slices, volume);
    note_colors(page, volume);
    output.allocate(volume);
    fill(slices, chosen, run, volume, output);
    return volume;
}

Reader find_reader(std::string_view format) { return format == "tiff" ? read_tiff : nullptr; }
ChunkedOpener find_chunked_opener(std::string_view) { return nullptr; }

}  // namespace chiaro::decode
