#include "decode/tiff_slices.h"

#include "decode/byte_source.h"
#include "decode/payload.h"
#include "decode/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

namespace chiaro::decode {
namespace {

using Path = std::filesystem::path;

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

}  // namespace

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

}  // namespace chiaro::decode
