// Light, shading and the choice of an illumination method.
#pragma once
#include <chiaro/medium.h>
#include <chiaro/settings.h>
#include <chiaro/transfer_function.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace chiaro {

enum class Shading { none, lambert, phong };

/// One directional light with Blinn-Phong reflection (Blinn 1977).
struct Lighting {
    Shading shading = Shading::phong;
    double ambient = 0.2, diffuse = 0.7, specular = 0.3, shininess = 20;
    bool headlight = true;                      ///< along the camera's axis, else azimuth and elevation
    double azimuth_deg = 0, elevation_deg = 0;  ///< towards the light, in the orbit's angles, fixed to the world
    Rgb color{1, 1, 1};                         ///< sRGB, as picked
    bool operator==(const Lighting&) const = default;
};

/// The methods that this build has; a new one is one new value and one new folder.
enum class Method { none };

struct IlluminationSettings {
    Method method = Method::none;
    bool operator==(const IlluminationSettings&) const = default;
};

struct MethodInfo {
    std::string name, sentence;
};
std::vector<MethodInfo> list_methods();

/// What depends on the data alone (local histograms, later); empty for most methods.
struct Prepared {};

/// The light that a method computed, looked up by the ray caster at every sample. Cheap to copy.
class IlluminationField {
public:
    struct Data;          // src/illumination/field.h
    IlluminationField();  ///< no illumination method: all light arrives
    explicit IlluminationField(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
    const Data& data() const { return *data_; }

private:
    std::shared_ptr<const Data> data_;
};

/// Receives a coarse field, then finer ones.
using Sink = std::function<void(IlluminationField)>;

Prepared prepare(const DeviceVolume& volume, const IlluminationSettings& settings, Progress& progress);

/// Hands at least one field to `sink` unless cancelled. Returns false when cancelled.
bool illuminate(const Device& device, const Medium& medium, const Prepared& prepared, const Lighting& lighting,
                const IlluminationSettings& settings, const Sink& sink, Progress& progress);

}  // namespace chiaro
