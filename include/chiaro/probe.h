// An environment map (HDRI, light probe): an equirectangular image of radiance.
#pragma once
#include <chiaro/export.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace chiaro {

/// Linear radiance (Rec. 709 primaries) over the sphere. Row 0 is up; what lies at the fraction s of the width, 0 at
/// the left, has azimuth 360° (½ - s). Cheap to copy; the image is shared and never changes. Two are equal where they
/// share it.
class Probe {
public:
    struct Data;  // src/illumination/probe/data.h

    Probe() = default;  ///< none
    /// Three floats a pixel, row after row; of any aspect. Negative values and NaN count as 0, infinite ones as 65504
    /// (the largest half). Projects the image on spherical harmonics: some 10 ns a pixel, on all cores. Throws
    /// Error{input} unless there are 1 to 65536 pixels a side and three values for each.
    CHIARO_EXPORT Probe(int width, int height, std::vector<float> rgb);

    explicit operator bool() const { return data_ != nullptr; }
    CHIARO_EXPORT int width() const;
    CHIARO_EXPORT int height() const;
    CHIARO_EXPORT std::span<const float> rgb() const;
    const Data& data() const { return *data_; }
    bool operator==(const Probe&) const = default;

private:
    std::shared_ptr<const Data> data_;
};

struct ProbeInfo {
    std::string name, sentence;
};
/// The probes that need no file.
CHIARO_EXPORT std::vector<ProbeInfo> list_probes();

/// One of list_probes(): functions of direction. White, matte surfaces get a luminance of 1 at most. Throws
/// Error{usage} with "did you mean".
CHIARO_EXPORT Probe builtin_probe(const std::string& name);

/// Whether this is meant as the name of a built-in probe, known or not, and not as a file: it holds neither '/' nor
/// '.'.
CHIARO_EXPORT bool is_probe_name(const std::string& source);

/// A probe by name, or from a Radiance (.hdr) or OpenEXR file of at most 100 megapixels. A file that stands upside down
/// is not guessed. Throws Error{usage} for an unknown name, Error{input} for a file that is missing or broken.
CHIARO_EXPORT Probe load_probe(const std::string& source);

}  // namespace chiaro
