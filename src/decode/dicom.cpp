// DICOM: GDCM decodes the pictures; which slices make a volume, and where they lie, is decided in dicom_series.cpp.
#include "decode/byte_source.h"
#include "decode/dicom_series.h"
#include "decode/limits.h"
#include "decode/readers.h"
#include "volume/validate.h"

#include <fmt/format.h>
#include <gdcmImageReader.h>
#include <gdcmTrace.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>

namespace chiaro::decode {
namespace {

using Path = std::filesystem::path;

std::vector<Path> files_in(const Path& path) {
    if (!std::filesystem::is_directory(path)) return {path};
    std::vector<Path> files;
    for (const auto& entry : std::filesystem::directory_iterator(path))
        if (entry.is_regular_file()) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

/// Every slice of every file; what is no image, or none that can be read, is skipped with a note.
std::vector<DicomSlice> scan(const Path& path, Volume& volume, Output& output) {
    const auto files = files_in(path);
    std::vector<DicomSlice> slices;
    std::size_t strangers = 0;
    std::string reason;
    for (std::size_t i = 0; i < files.size(); ++i) {
        output.progress(0.3 * double(i) / double(files.size()));
        output.at(files[i].filename().string());
        try {
            const auto found = scan_dicom_file(files[i]);
            strangers += found.empty();
            slices.insert(slices.end(), found.begin(), found.end());
        } catch (const std::exception& error) {
            reason = fmt::format("'{}' {}", files[i].filename().string(), error.what());
            ++strangers;
        }
    }
    if (slices.empty() && !reason.empty()) refuse("holds no DICOM image that can be read: " + reason);
    if (slices.empty())
        refuse(!std::filesystem::is_directory(path) ? "is no DICOM image"
               : files.empty()                      ? "the folder is empty"
                               : fmt::format("the folder holds no DICOM image, but {} other file{}", files.size(),
                                             files.size() == 1 ? "" : "s"));
    if (strangers > 0)
        volume.notes.push_back(fmt::format("{} files that are no readable images were skipped{}", strangers,
                                           reason.empty() ? "" : ": " + reason));
    return slices;
}

std::size_t index_of(const std::vector<DicomSeries>& all, const std::string& wanted) {
    if (wanted.empty()) return 0;
    std::size_t position = 0;
    const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), position);
    if (error == std::errc{} && end == wanted.data() + wanted.size() && position >= 1 && position <= all.size())
        return position - 1;
    for (std::size_t i = 0; i < all.size(); ++i)
        if (all[i][0].series == wanted) return i;
    refuse(fmt::format("has no series '{}', but {}, numbered from 1 (the largest)", wanted, all.size()));
}

DicomSeries choose(std::vector<DicomSeries> all, const std::string& wanted, Volume& volume) {
    const std::size_t chosen = index_of(all, wanted);
    std::string others;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (i == chosen) continue;
        const auto& first = all[i][0];
        others += fmt::format("{}{} ({} slices of {} x {}{}{}, {})", others.empty() ? "" : "; ", i + 1, all[i].size(),
                              first.columns, first.rows, first.description.empty() ? "" : ", ", first.description,
                              first.series);
    }
    if (!others.empty()) volume.notes.push_back("other series here: " + others);
    return std::move(all[chosen]);
}

bool same_rescale(const DicomSeries& series) {
    return std::all_of(series.begin(), series.end(),
                       [&](auto& s) { return s.slope == series[0].slope && s.intercept == series[0].intercept; });
}

/// Notices where a file ends too early: GDCM itself fills up with zeros what is missing, and calls it good.
class WatchedFile : public std::filebuf {
public:
    explicit WatchedFile(const Path& path) { open(path, std::ios::in | std::ios::binary); }
    bool is_truncated() const { return truncated_; }

protected:
    std::streamsize xsgetn(char* to, std::streamsize count) override {
        const std::streamsize got = std::filebuf::xsgetn(to, count);
        constexpr std::streamsize tag = 4;  // trying for one more element is how a parser finds the regular end
        truncated_ = truncated_ || (got < count && (got > 0 || count > tag));
        return got;
    }

private:
    bool truncated_ = false;
};

/// The bytes of all pictures of a file. GDCM allocates what is stated before it looks what is there: a file of a
/// kilobyte may cost little more.
std::size_t expected_bytes(const DicomSlice& slice) {
    constexpr std::uint64_t always = 8 << 20, largest_ratio = 256;  // run lengths reach 64; codecs, of empty pictures
    const std::uint64_t stored = regular_file_size(slice.path), bytes = slice.bytes() * std::uint64_t(slice.frames);
    if (bytes > always + largest_ratio * stored)
        refuse(fmt::format("states {} bytes of pixels, but has only {} bytes in all", bytes, stored));
    limit_own_memory(working_memory + 4 * (stored + bytes));
    return bytes;
}

/// All pictures of one file, in the stored type.
std::vector<std::byte> decode_file(const DicomSlice& slice) {
    try {
        const std::size_t bytes = expected_bytes(slice);
        WatchedFile file(slice.path);
        std::istream stream(&file);
        gdcm::ImageReader reader;
        reader.SetStream(stream);
        const bool read = reader.Read();
        const gdcm::TransferSyntax syntax = reader.GetFile().GetHeader().GetDataSetTransferSyntax();
        if (syntax == gdcm::TransferSyntax::DeflatedExplicitVRLittleEndian)
            refuse("is deflated as a whole, a transfer syntax that is not read");
        if (file.is_truncated()) refuse("is truncated");
        if (!read) refuse("cannot be decoded");
        const gdcm::Image& image = reader.GetImage();
        if (syntax.IsEncapsulated() != (image.GetDataElement().GetSequenceOfFragments() != nullptr))
            refuse(
                fmt::format("states the transfer syntax {}, but its pixels are stored in another", syntax.GetString()));
        if (image.GetBufferLength() != bytes || image.GetPixelFormat().GetPixelSize() != size_of(slice.type))
            refuse(fmt::format("holds {} bytes of pixels where {} are needed", image.GetBufferLength(), bytes));
        if (const auto* value = image.GetDataElement().GetByteValue(); value && value->GetLength() < bytes)
            refuse(
                fmt::format("holds {} bytes of pixels where {} are needed", std::uint64_t(value->GetLength()), bytes));
        std::vector<std::byte> pixels(bytes);
        if (!image.GetBuffer(reinterpret_cast<char*>(pixels.data()))) refuse("holds pixels that cannot be decoded");
        return pixels;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        refuse(fmt::format("'{}' {}", slice.path.filename().string(), error.what()));
    }
}

/// Stored pixels to values, where slices differ in slope: one slope cannot say what they mean.
void rescale(const DicomSlice& slice, const std::byte* from, std::byte* to) {
    with_voxel_type(slice.type, [&](auto zero) {
        using T = decltype(zero);
        for (std::size_t i = 0; i < slice.bytes() / sizeof(T); ++i) {
            T stored;
            std::memcpy(&stored, from + i * sizeof(T), sizeof(T));
            const float value = float(slice.slope * double(stored) + slice.intercept);
            std::memcpy(to + i * sizeof(float), &value, sizeof(float));
        }
    });
}

/// Fills the slots between slices that are there with what lies between them.
template <class T>
void interpolate_missing(const DicomSeries& series, std::span<T> voxels, std::size_t slice) {
    for (std::size_t i = 1; i < series.size(); ++i) {
        const auto below = std::size_t(series[i - 1].slot), above = std::size_t(series[i].slot);
        for (std::size_t z = below + 1; z < above; ++z)
            for (std::size_t k = 0; k < slice; ++k) {
                const double a = double(voxels[below * slice + k]), b = double(voxels[above * slice + k]);
                const double value = a + (b - a) * double(z - below) / double(above - below);
                voxels[z * slice + k] = T(std::is_integral_v<T> ? std::round(value) : value);
            }
    }
}

void fill(const DicomSeries& series, bool rescaled, Volume& volume, Output& output) {
    std::vector<std::byte> pixels;
    const Path* decoded = nullptr;
    const std::size_t slice_bytes = volume.voxels.size() / std::size_t(volume.dimensions[2]);
    for (std::size_t z = 0; z < series.size(); ++z) {
        const DicomSlice& slice = series[z];
        output.at(slice.path.filename().string());
        if (!decoded || *decoded != slice.path) pixels = decode_file(slice);
        decoded = &slice.path;
        const std::byte* from = pixels.data() + std::size_t(slice.frame) * slice.bytes();
        std::byte* to = volume.voxels.data() + std::size_t(slice.slot) * slice_bytes;
        if (rescaled)
            rescale(slice, from, to);
        else
            std::copy_n(from, slice_bytes, to);
        output.progress(0.3 + 0.7 * double(z + 1) / double(series.size()));
    }
    with_voxel_type(volume.type, [&](auto zero) {
        using T = decltype(zero);
        interpolate_missing(series, volume.as<T>(), slice_bytes / sizeof(T));
    });
}

}  // namespace

Volume read_dicom(const Path& path, const std::string& wanted, Output& output) {
    gdcm::Trace::WarningOff();
    gdcm::Trace::ErrorOff();
    Volume volume;
    volume.format = "DICOM";
    DicomSeries series = choose(group_series(scan(path, volume, output)), wanted, volume);
    arrange(series, output, volume);
    const DicomSlice& first = series[0];
    const bool rescaled = !same_rescale(series);
    volume.type = rescaled ? VoxelType::f32 : first.type;
    const int slices = series.back().slot + 1;
    checked_bytes({first.columns, first.rows, slices}, 1, volume.type);
    volume.dimensions = {first.columns, first.rows, slices};
    if (rescaled)
        volume.notes.push_back("slices differ in rescale slope or intercept; values were computed as 32-bit floats");
    else
        volume.slope = first.slope, volume.intercept = first.intercept;
    volume.modality = first.modality;
    if (!first.series.empty()) volume.key_values["SeriesInstanceUID"] = first.series;
    if (!first.description.empty()) volume.key_values["SeriesDescription"] = first.description;
    output.allocate(volume);
    fill(series, rescaled, volume, output);
    return volume;
}

Reader find_reader(std::string_view format) { return format == "dicom" ? read_dicom : nullptr; }
ChunkedOpener find_chunked_opener(std::string_view) { return nullptr; }

}  // namespace chiaro::decode
