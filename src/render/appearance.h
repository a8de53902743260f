// From the settings of a scene to what the stages take.
#pragma once
#include <chiaro/scene.h>

#include <string>

namespace chiaro {

/// What is known of a volume once it has been measured.
struct Subject {
    std::string source;  ///< as in Volume
    Statistics statistics;
    Guess guess;
    ComponentInfo component = {};  ///< of a volume of one value
};

/// Throws Error{interrupted} when cancelled.
Subject study(const Volume& volume, const Progress& progress);

/// The transfer function that the settings ask for - their points, a named one, else a sample's own or the guessed
/// preset - with their window and opacity unit applied. Throws as load_transfer_function.
TransferFunction transfer_function_for(const TransferSettings& settings, const Subject& subject);

/// That of a channel, number `index` of `count`: as its settings say, else of one alone the guessed one, of several a
/// ramp over its values in the file's colour, or one of its own (ImageJ's order: red, green, blue, white, cyan,
/// magenta, yellow). Throws as load_transfer_function.
TransferFunction transfer_function_of_channel(const ChannelSettings& channel, std::size_t index, std::size_t count,
                                              const TransferSettings& of_scene, const Subject& subject);
/// What the opacity of a volume in its own colours is by: a ramp over luminance as of a channel, alpha as it is, or
/// what the settings ask for. Throw as load_transfer_function.
TransferFunction of_luminance(const TransferSettings& settings, const Subject& subject);
TransferFunction of_alpha(const TransferSettings& settings, const Subject& subject);
/// The value of white of colours up to `most`: 1, or the least 2^k - 1 from 255 on.
double white_of(double most);
/// Whether the volume is its own labels, so that they are solids and nothing else is shown.
bool are_labels_alone(const Scene& scene);
/// White all over, of which labels leave their own shapes and colours, unless the settings ask for another.
TransferFunction of_labels_alone(const TransferSettings& settings, const Subject& subject);

/// Linear, as drafts are, or by texture.
Shape shape_for(const Scene& scene);

/// Whether final pictures are found another way than drafts.
bool has_finer_interpolation(const Scene& scene);
/// Whether drafts are linear where final pictures are not.
bool has_linear_drafts(const Scene& scene);
/// Whether light comes from opacities alone, whatever colours are.
bool sees_opacities_alone(const IlluminationSettings& settings);
/// What opacities come from: the same, its points without colours and names.
TransferSettings without_colors(TransferSettings settings);
/// The medium of final pictures. `medium`: of drafts; `noise`: as Statistics has it.
Medium finely_interpolated(const Device& device, const Medium& medium, const Scene& scene, double noise,
                           const Progress& progress);

/// Whether its pictures look up voxels only where the medium shows something (see discard_unseen).
bool looks_at_visible_voxels(const Scene& scene);

/// How a probe is turned whose settings do not tell: as the camera of a volume's first picture is (look_from), so that
/// its lights stand beside that as they do around volumes without an anatomical frame.
void turn_by_frame(ProbeSettings& probe, World world);
/// With the probe that its settings name; as it is where they name none. Throws as load_probe.
Lighting with_probe(Lighting lighting);

}  // namespace chiaro
