#include "decode/dicom_scan.h"

#include "decode/byte_source.h"
#include "decode/dicom_elements.h"
#include "decode/limits.h"
#include "decode/output.h"
#include "decode/text.h"

#include <fmt/format.h>
#include <gdcmAttribute.h>
#include <gdcmImageHelper.h>
#include <gdcmReader.h>
#include <gdcmSequenceOfItems.h>

#include <algorithm>
#include <fstream>

namespace chiaro::decode {
namespace {

using gdcm::DataSet;
using gdcm::Tag;

std::string text_of(const DataSet& data, const Tag& tag) {
    if (!data.FindDataElement(tag)) return {};
    const gdcm::ByteValue* value = data.GetDataElement(tag).GetByteValue();
    if (!value) return {};
    const std::string text(value->GetPointer(), value->GetLength());
    return trimmed(text.substr(0, text.find('\0')));
}

/// The numbers of a decimal string, "1\2\3"; empty unless there are exactly `count`.
std::vector<double> decimals(const DataSet& data, const Tag& tag, std::size_t count) {
    std::vector<double> values;
    for (const auto& word : words(text_of(data, tag), "\\")) values.push_back(number(word, "DICOM number"));
    return values.size() == count ? values : std::vector<double>{};
}

double decimal_or(const DataSet& data, const Tag& tag, double fallback) {
    const auto values = decimals(data, tag, 1);
    return values.empty() ? fallback : values[0];
}

VoxelType dicom_type(const gdcm::PixelFormat& format) {
    if (format.GetSamplesPerPixel() != 1)
        refuse(fmt::format("has {} samples a pixel; only grey images are read", format.GetSamplesPerPixel()));
    switch (format.GetScalarType()) {
        case gdcm::PixelFormat::UINT8:
            return VoxelType::u8;
        case gdcm::PixelFormat::INT8:
            return VoxelType::i8;
        case gdcm::PixelFormat::UINT16:
            return VoxelType::u16;
        case gdcm::PixelFormat::INT16:
            return VoxelType::i16;
        case gdcm::PixelFormat::UINT32:
            return VoxelType::u32;
        case gdcm::PixelFormat::INT32:
            return VoxelType::i32;
        case gdcm::PixelFormat::FLOAT32:
            return VoxelType::f32;
        case gdcm::PixelFormat::FLOAT64:
            return VoxelType::f64;
        default:
            refuse(fmt::format("has pixels of {} bits, not 8, 16, 32 or 64", format.GetBitsAllocated()));
    }
}

/// One number that is stored as such.
template <std::uint16_t group, std::uint16_t element, long long type>
std::optional<double> stored_number(const DataSet& data) {
    if (!data.FindDataElement(Tag(group, element)) || data.GetDataElement(Tag(group, element)).IsEmpty()) return {};
    gdcm::Attribute<group, element, type, gdcm::VM::VM1> attribute;
    attribute.SetFromDataSet(data);
    return double(attribute.GetValue());
}

/// When the picture was taken: trigger time or delay, temporal position or index.
void take_time(const DataSet& data, DicomSlice& slice) {
    const auto take = [](std::optional<double>& known, std::optional<double> stated) {
        if (stated) known = stated;
    };
    if (const auto trigger = decimals(data, Tag(0x0018, 0x1060), 1); !trigger.empty()) slice.trigger_ms = trigger[0];
    if (const auto position = decimals(data, Tag(0x0020, 0x0100), 1); !position.empty()) slice.temporal = position[0];
    take(slice.trigger_ms, stored_number<0x0018, 0x9153, gdcm::VR::FD>(data));
    take(slice.temporal, stored_number<0x0020, 0x9128, gdcm::VR::UL>(data));
}

/// Position, orientation, spacing and rescale, as far as `data` states them: a whole data set, or one macro of an
/// enhanced image.
void take_place(const DataSet& data, DicomSlice& slice) {
    const auto position = decimals(data, Tag(0x0020, 0x0032), 3), orientation = decimals(data, Tag(0x0020, 0x0037), 6);
    if (!position.empty()) slice.position = {position[0], position[1], position[2]};
    if (!orientation.empty()) {
        slice.along_row = {orientation[0], orientation[1], orientation[2]};
        slice.along_column = {orientation[3], orientation[4], orientation[5]};
    }
    slice.has_place = slice.has_place || !position.empty();
    for (const Tag& tag : {Tag(0x0028, 0x0030), Tag(0x0018, 0x1164)})  // PixelSpacing, ImagerPixelSpacing
        if (const auto spacing = decimals(data, tag, 2); !spacing.empty()) {
            slice.row_spacing = spacing[0];  // the first number lies between rows: y
            slice.column_spacing = spacing[1];
            break;
        }
    slice.thickness = decimal_or(data, Tag(0x0018, 0x0088), decimal_or(data, Tag(0x0018, 0x0050), slice.thickness));
    slice.slope = decimal_or(data, Tag(0x0028, 0x1053), decimal_or(data, Tag(0x3004, 0x000e), slice.slope));  // dose
    slice.intercept = decimal_or(data, Tag(0x0028, 0x1052), slice.intercept);
    take_time(data, slice);
}

gdcm::SmartPointer<gdcm::SequenceOfItems> sequence(const DataSet& data, const Tag& tag) {
    if (!data.FindDataElement(tag)) return nullptr;
    return data.GetDataElement(tag).GetValueAsSQ();
}

/// Everything in the functional-group macros of one item: they are sequences of one item each.
void take_macros(const DataSet& item, DicomSlice& slice) {
    for (const Tag& tag : {Tag(0x0020, 0x9113), Tag(0x0020, 0x9116), Tag(0x0028, 0x9110), Tag(0x0028, 0x9145),
                           Tag(0x0018, 0x9118), Tag(0x0020, 0x9111)})
        if (const auto macro = sequence(item, tag); macro && macro->GetNumberOfItems() > 0)
            take_place(macro->GetItem(1).GetNestedDataSet(), slice);
}

/// Where the frames of a file lie that states one place for all, in mm along the normal from there: dose grids list
/// the offsets, nuclear medicine a spacing, which may be negative. Empty where there is neither.
std::vector<double> offsets_of_frames(const DataSet& data, int count) {
    auto offsets = decimals(data, Tag(0x3004, 0x000c), std::size_t(count));
    if (!offsets.empty()) {
        const double first = offsets[0];
        for (double& offset : offsets) offset -= first;
    } else if (const double spacing = decimal_or(data, Tag(0x0018, 0x0088), 0); spacing != 0) {
        for (int i = 0; i < count; ++i) offsets.push_back(i * spacing);
    }
    return offsets;
}

/// Gives frames without a place of their own the one that follows from the file's.
void place_frames(const DataSet& data, DicomSlice first, std::vector<DicomSlice>& frames) {
    if (const auto detectors = sequence(data, Tag(0x0054, 0x0022)); detectors && detectors->GetNumberOfItems() > 0)
        take_place(detectors->GetItem(1).GetNestedDataSet(), first);
    const auto offsets = offsets_of_frames(data, int(frames.size()));
    if (!first.has_place || offsets.empty()) return;
    const Vec3 normal = cross(first.along_row, first.along_column);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        frames[i].has_place = true;
        frames[i].along_row = first.along_row;
        frames[i].along_column = first.along_column;
        frames[i].position = first.position + offsets[i] * normal;
    }
}

std::vector<DicomSlice> frames_of(const DataSet& data, const DicomSlice& common, int count) {
    const auto shared = sequence(data, Tag(0x5200, 0x9229)), each = sequence(data, Tag(0x5200, 0x9230));
    DicomSlice first = common;
    if (shared && shared->GetNumberOfItems() > 0) take_macros(shared->GetItem(1).GetNestedDataSet(), first);
    std::vector<DicomSlice> frames;
    for (int i = 0; i < count; ++i) {
        DicomSlice frame = first;
        frame.frame = frame.instance = i;
        frame.frames = count;
        frame.has_place = false;
        if (each && each->GetNumberOfItems() == std::size_t(count))
            take_macros(each->GetItem(std::size_t(i) + 1).GetNestedDataSet(), frame);
        frames.push_back(frame);
    }
    if (std::none_of(frames.begin(), frames.end(), [](auto& f) { return f.has_place; }))
        place_frames(data, first, frames);
    return frames;
}

/// A file without preamble may be DICOM all the same; one that starts with neither is not worth a parser's time.
bool may_be_dicom(const std::filesystem::path& path) {
    std::array<std::byte, 132> start{};
    const std::size_t n = open_plain(path)->read(start);
    const std::string_view text(reinterpret_cast<const char*>(start.data()), n);
    return n == start.size() && (text.substr(128) == "DICM" || (text[0] == 8 && text[1] == 0));
}

}  // namespace

std::vector<DicomSlice> scan_dicom_file(const std::filesystem::path& path) {
    if (!may_be_dicom(path)) return {};
    check_dicom_elements(path);
    limit_own_memory(working_memory + 4 * regular_file_size(path));
    std::ifstream stream(path, std::ios::binary);
    gdcm::Reader reader;
    reader.SetStream(stream);
    if (!reader.ReadUpToTag(Tag(0x7fe0, 0x0010))) return {};
    const gdcm::File& file = reader.GetFile();
    const DataSet& data = file.GetDataSet();
    gdcm::Attribute<0x0028, 0x0010> rows{0};
    gdcm::Attribute<0x0028, 0x0011> columns{0};
    rows.Set(data);
    columns.Set(data);
    if (rows.GetValue() == 0 || columns.GetValue() == 0) return {};
    DicomSlice slice;
    slice.path = path;
    slice.rows = rows.GetValue();
    slice.columns = columns.GetValue();
    slice.type = dicom_type(gdcm::ImageHelper::GetPixelFormatValue(file));
    slice.series = text_of(data, Tag(0x0020, 0x000e));
    slice.description = text_of(data, Tag(0x0008, 0x103e));
    slice.modality = text_of(data, Tag(0x0008, 0x0060));
    slice.instance = int(decimal_or(data, Tag(0x0020, 0x0013), 0));
    take_place(data, slice);
    const double count = decimal_or(data, Tag(0x0028, 0x0008), 1);
    if (!(count >= 1 && count <= 65535)) refuse(fmt::format("states {} frames", count));
    return count > 1 ? frames_of(data, slice, int(count)) : std::vector{slice};
}

}  // namespace chiaro::decode
