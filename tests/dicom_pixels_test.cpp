// DICOM with compressed pixels: what every codec stores is what is read.
#include "volume_files.h"

#include <chiaro/error.h>
#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmImageReader.h>
#include <gdcmImageWriter.h>
#include <gdcmUIDGenerator.h>

#include <sstream>

using namespace chiaro;
using namespace volume_files;

namespace {

/// The same image in another transfer syntax.
std::string compressed(const std::string& plain, gdcm::TransferSyntax::TSType syntax) {
    std::istringstream in(plain);
    gdcm::ImageReader reader;
    reader.SetStream(in);
    EXPECT_TRUE(reader.Read());
    gdcm::ImageChangeTransferSyntax change;
    change.SetTransferSyntax(syntax);
    change.SetInput(reader.GetImage());
    EXPECT_TRUE(change.Change());
    gdcm::ImageWriter writer;
    writer.SetFile(reader.GetFile());
    writer.SetImage(change.GetOutput());
    std::ostringstream out;
    writer.SetStream(out);
    EXPECT_TRUE(writer.Write());
    return out.str();
}

struct Codec {
    const char* name;
    gdcm::TransferSyntax::TSType syntax;
    int tolerance = 0;
};
const Codec codecs[] = {{"RLE", gdcm::TransferSyntax::RLELossless},
                        {"JPEG lossless", gdcm::TransferSyntax::JPEGLosslessProcess14_1},
                        {"JPEG-LS", gdcm::TransferSyntax::JPEGLSLossless},
                        {"JPEG 2000", gdcm::TransferSyntax::JPEG2000Lossless},
                        {"JPEG baseline", gdcm::TransferSyntax::JPEGBaselineProcess1, 6}};

/// Smooth, so that lossy codecs stay close; 40 x 30 pixels.
Dicom dicom_image(int z, bool bytes_only, int frames = 1) {
    Dicom slice{.columns = 40, .rows = 30, .instance = z + 1, .position = {0, 0, 3.0 * z}, .pixels = {}};
    slice.bytes_only = bytes_only;
    slice.frames = frames;
    for (int f = 0; f < frames; ++f)
        for (int y = 0; y < 30; ++y)
            for (int x = 0; x < 40; ++x)
                slice.pixels.push_back(std::uint16_t((3 * x + 2 * y + 10 * (z + f)) * (bytes_only ? 1 : 100)));
    return slice;
}

template <class T>
void expect_pixels(const Volume& volume, const std::vector<Dicom>& slices, int tolerance) {
    ASSERT_EQ(volume.type, voxel_type_of<T>());
    std::size_t i = 0;
    for (const auto& slice : slices)
        for (const auto pixel : slice.pixels) ASSERT_NEAR(volume.as<T>()[i++], T(pixel), tolerance);
    EXPECT_EQ(i, volume.voxel_count());
}

}  // namespace

TEST(DicomPixels, EveryCodecGivesWhatWasStored) {
    for (const Codec& codec : codecs)
        for (const bool bytes_only : {true, false}) {
            if (codec.tolerance > 0 && !bytes_only) continue;  // baseline has 8 bits
            SCOPED_TRACE(codec.name);
            const Folder folder;
            std::vector<Dicom> slices;
            for (int z = 0; z < 3; ++z) {
                slices.push_back(dicom_image(z, bytes_only));
                folder.write("IM" + std::to_string(z), compressed(slices[std::size_t(z)].bytes(), codec.syntax));
            }
            const auto volume = read(folder.name());
            EXPECT_EQ(volume.dimensions, (std::array{40, 30, 3}));
            bytes_only ? expect_pixels<std::uint8_t>(volume, slices, codec.tolerance)
                       : expect_pixels<std::uint16_t>(volume, slices, codec.tolerance);
            EXPECT_TRUE(volume.notes.empty()) << volume.notes[0];
        }
}

TEST(DicomPixels, FramesAreCompressedOneByOne) {
    for (const Codec& codec : codecs) {
        SCOPED_TRACE(codec.name);
        const Folder folder;
        const Dicom image = dicom_image(0, true, 4);
        const auto volume = read(folder.write("frames.dcm", compressed(image.bytes(), codec.syntax)));
        EXPECT_EQ(volume.dimensions, (std::array{40, 30, 4}));
        expect_pixels<std::uint8_t>(volume, {image}, codec.tolerance);
    }
}

TEST(DicomPixels, SignedPixels) {
    const Folder folder;
    Dicom image = dicom_image(0, false);
    image.is_signed = true;
    for (auto& pixel : image.pixels) pixel = std::uint16_t(pixel - 5000);
    for (const Codec& codec : codecs) {
        if (codec.tolerance > 0) continue;
        SCOPED_TRACE(codec.name);
        expect_pixels<std::int16_t>(read(folder.write("a.dcm", compressed(image.bytes(), codec.syntax))), {image}, 0);
    }
}

TEST(DicomPixels, TruncatedStreamsAreRefused) {
    const Folder folder;
    for (const Codec& codec : codecs) {
        const std::string whole = compressed(dicom_image(0, true).bytes(), codec.syntax);
        for (const std::size_t left : {whole.size() - 1, whole.size() - 40, whole.size() - 200}) {
            SCOPED_TRACE(codec.name + std::to_string(whole.size() - left));
            EXPECT_THROW(read(folder.write("cut.dcm", whole.substr(0, left))), Error);
        }
    }
}
