// TIFF: libtiff decodes the pages; which of them make a volume, and their place, is decided here.
#include "decode/byte_source.h"
#include "decode/limits.h"
#include "decode/payload.h"
#include "decode/readers.h"
#include "decode/tiff_slices.h"
#include "volume/validate.h"

#include <fmt/format.h>

#include <algorithm>

namespace chiaro::decode {
namespace {

using Path = std::filesystem::path;

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

/// A volume but for its voxels, and where these are.
struct TiffStack {
    Volume header;
    std::vector<Slice> slices;
    ChosenPages chosen;
    std::optional<Run> run;

    const TiffPage& page() const { return slices[0].page; }
};

TiffStack open_stack(const Path& path, Output& output) {
    TiffStack stack;
    auto& [volume, slices, chosen, run] = stack;
    volume.format = "TIFF";
    slices = slices_of(path, volume, output);
    keep_one_kind(slices, volume);
    const bool is_folder = slices.front().path != slices.back().path;
    const TiffLayout layout =
        is_folder ? TiffLayout{}
                  : layout_from(slices[0].page.description, std::int64_t(slices.size()), slices[0].page.samples);
    if (!layout.planes.empty()) {
        slices = planes_in_files(std::move(slices), layout, volume, output);
        keep_one_kind(slices, volume);
    }
    const TiffPage& page = slices[0].page;
    if (!layout.metadata_file.empty())
        volume.notes.push_back("what its pages are is told in '" + layout.metadata_file + "', which is not read");
    run = run_of(slices[0], layout, slices.size());
    chosen = choose_pages(layout, page, slices.size(), run.has_value(), output, volume);
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
    return stack;
}

/// Pixels of one page after the other.
class TiffReader {
public:
    TiffReader(const TiffStack& stack, Output& output) : stack_(stack), output_(output) {}

    /// Of the page of one channel of a slice. Throws Error{input}.
    void read(std::size_t slice, int channel, const PixelBox& box, const PixelTarget& target) {
        const ChosenPages& chosen = stack_.chosen;
        const std::size_t page = chosen.pages[slice * std::size_t(chosen.channels) + std::size_t(channel)];
        if (stack_.run) return read_run(page, box, target);
        const Slice& wanted = stack_.slices[page];
        try {
            if (current_ != &wanted) go_to(wanted);
            read_pixels(file_.get(), page_, box, target);
        } catch (const Error& error) {
            refuse(fmt::format("'{}' {}", wanted.path.filename().string(), error.what()));
        }
    }

private:
    void go_to(const Slice& slice) {
        output_.at(slice.path.filename().string());
        if (!current_ || current_->path != slice.path) file_ = open_tiff(slice.path);
        current_ = nullptr;
        if (!TIFFSetSubDirectory(file_.get(), slice.directory)) refuse("has a page that cannot be found again");
        page_ = scan_page(file_.get(), regular_file_size(slice.path));
        if (!page_.same_kind(slice.page)) refuse("has a page that changed while it was read");
        current_ = &slice;
    }

    void read_run(std::size_t page, const PixelBox& box, const PixelTarget& target) {
        const TiffPage& first = stack_.page();
        const std::size_t row_bytes = first.bytes() / std::size_t(first.rows);
        rows_.resize(row_bytes * std::size_t(box.rows));
        const std::uint64_t at = stack_.run->offset + page * first.bytes() + std::size_t(box.row) * row_bytes;
        fill_from_bytes(*open_plain(stack_.slices[0].path, at), stack_.run->big_endian, first.type, rows_, output_);
        put_pixels(first, {0, box.row, first.columns, box.rows}, rows_.data(), 1, 0, box, target);
    }

    const TiffStack& stack_;
    Output& output_;
    TiffFile file_;
    const Slice* current_ = nullptr;  ///< the page that the file is at
    TiffPage page_;
    std::vector<std::byte> rows_;
};

/// A stack by the strips or tiles of its pages, or by as many as make a box that is worth to be asked for.
class TiffChunks final : public ChunkedFile {
public:
    TiffChunks(const Path& path, Output& output) : stack_(open_stack(path, output)), reader_(stack_, output) {
        header_ = std::move(stack_.header);
        check_header(header_);
        const TiffPage& page = stack_.page();
        PixelBox box{.columns = page.columns, .rows = 1};
        std::uint64_t bytes = 0;
        if (!stack_.run) {
            const TiffFile file = open_tiff(stack_.slices[0].path);
            if (!TIFFSetSubDirectory(file.get(), stack_.slices[0].directory)) refuse("has a page that is damaged");
            box = strip_of(file.get(), page);
            bytes = strip_bytes(file.get());
        }
        const ChunkedLevel level{header_.dimensions,
                                 {grown_edge(box.columns, page.columns), grown_edge(box.rows, page.rows), 1},
                                 header_.geometry};
        bytes = std::max(bytes, level.chunk_voxels() * size_of(header_.type));
        if (bytes > largest_chunk_bytes)
            refuse(fmt::format("has strips or tiles of more than {} MiB", largest_chunk_bytes >> 20));
        limit_own_memory((std::uint64_t(96) << 20) + 4 * bytes);
        levels_ = {level};
    }

    bool read(int, const std::array<int, 3>& chunk, int component, std::span<std::byte> to) override {
        const auto& [width, height, depth] = levels_[0].chunk;
        const TiffPage& page = stack_.page();
        PixelBox box{chunk[0] * width, chunk[1] * height, width, height};
        box.columns = std::min(width, page.columns - box.column);
        box.rows = std::min(height, page.rows - box.row);
        reader_.read(std::size_t(chunk[2]), component / page.values, box,
                     {.to = to.data(), .first = component % page.values, .line = std::size_t(width)});
        return true;
    }

private:
    TiffStack stack_;
    TiffReader reader_;
};

std::unique_ptr<ChunkedFile> open_tiff_chunks(const Path& path, const std::string&, Output& output) {
    return std::make_unique<TiffChunks>(path, output);
}

}  // namespace

Volume read_tiff(const Path& path, const std::string&, Output& output) {
    TiffStack stack = open_stack(path, output);
    Volume& volume = stack.header;
    output.allocate(volume);
    const TiffPage& page = stack.page();
    TiffReader reader(stack, output);
    const auto [columns, rows, depth] = volume.dimensions;
    const auto pixel = std::size_t(volume.components), line = pixel * std::size_t(columns);
    for (int z = 0; z < depth; ++z)
        for (int channel = 0; channel < stack.chosen.channels; ++channel) {
            const std::size_t value = std::size_t(z) * std::size_t(rows) * line + std::size_t(channel * page.values);
            output.progress(0.2 + 0.8 * double(z) / double(depth));
            reader.read(std::size_t(z), channel, {0, 0, columns, rows},
                        {volume.voxels.data() + value * size_of(volume.type), 0, page.values, pixel, line});
        }
    return std::move(volume);
}

Reader find_reader(std::string_view format) { return format == "tiff" ? read_tiff : nullptr; }
ChunkedOpener find_chunked_opener(std::string_view format) { return format == "tiff" ? open_tiff_chunks : nullptr; }

}  // namespace chiaro::decode
