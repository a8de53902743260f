// Every setting of a picture, told once. `describe(visit, settings)` calls visit(Setting, field...) for each setting,
// with the field (rarely fields) that it sets, const when `settings` is.
#pragma once
#include <chiaro/scene.h>
#include <chiaro/text.h>

#include <concepts>
#include <functional>
#include <map>
#include <string>
#include <type_traits>

namespace chiaro {

// A setting reads best in a line, or in two: what it is, and what it takes.
// clang-format off

template <class S, class Settings>
concept SettingsOf = std::same_as<std::remove_const_t<S>, Settings>;

template <class Visit, SettingsOf<ReadOptions> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"raw-size", "volume.raw_size", "voxels", "size of a raw volume"}
          .within(1, 65535).written("XxYxZ"), s.raw.dimensions);
    visit(Setting{"raw-type", "volume.raw_type", "", "voxel type of a raw volume"}, s.raw.type);
    visit(Setting{"raw-spacing", "volume.raw_spacing", "mm",
                  "voxel spacing of a raw volume"}.above(0), s.raw.spacing_mm);
    visit(Setting{"raw-endian", "volume.raw_endian", "", "byte order of a raw volume"}
          .written("little|big"), s.raw.big_endian);
    visit(Setting{"raw-offset", "volume.raw_offset", "bytes", "bytes before the first voxel of a raw volume"}
          .within(0, 1e15), s.raw.offset);
    visit(Setting{"series", "volume.series", "",
                  "one of several DICOM series: its UID, or its number by size (1 = largest)"}
          .written("UID|N"), s.series);
    visit(Setting{"rescale", "volume.rescale", "", "value = SLOPE * stored + INTERCEPT, where a file lacks it"}
          .written("SLOPE,INTERCEPT"), s.rescale);
    visit(Setting{"time", "volume.time", "",
                  "which moment of a volume that changes with time, from 0; its range and camera are the first one's"}
          .within(0, 1e9), s.time);
    visit(Setting{"channels-as", "volume.channels_as", "",
                  "three or four values a voxel: shown in their own colours, or as channels (as the file says)"},
          s.components_as);
}

template <class Visit, SettingsOf<LabelSettings> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"labels", "labels.file", "", "volume of labels (whole numbers) of structures in the volume, which are tinted, thinned or hidden"}
          .written("VOLUME"), s.source);
    visit(Setting{"label-table", "labels.table", "",
                  "how labels are shown: our own table, one of ITK-SNAP, 3D Slicer, FreeSurfer or nnU-Net, or totalsegmentator"}
          .written("FILE"), s.table);
}

template <class Visit, SettingsOf<TransferSettings> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"transfer", "transfer_function", "",
                  "transfer function: a file, a preset or a colour map (guessed from the data)"}
          .written("FILE|PRESET").kept(SceneForm::custom), s.source);
    visit(Setting{"window", "window", "", "stretches the transfer function over these values"}
          .written("CENTER,WIDTH"), s.window);
    visit(Setting{"threshold", "threshold", "", "makes values outside transparent"}.written("LO,HI"), s.threshold);
    visit(Setting{"opacity-scale", "transfer_function.opacity_scale", "", "multiplies the extinction"}
          .within(0, 1e6), s.opacity_scale);
    visit(Setting{"opacity-unit", "transfer_function.opacity_unit_distance", "voxels",
                  "length that opacities belong to, in units of the smallest voxel size"}
          .above(0), s.opacity_unit);
    visit(Setting{"opacity-unit-mm", "transfer_function.opacity_unit_mm", "mm",
                  "length that opacities belong to, in millimetres"}
          .above(0), s.opacity_unit_mm);
}

/// Scene files only: no flags.
template <class Visit, SettingsOf<ExpectedVolume> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"", "volume.dims", "voxels",
                  "size of the volume, checked"}.within(1, 65535).written("XxYxZ"), s.dimensions);
    visit(Setting{"", "volume.type", "", "voxel type of the volume, checked"}, s.type);
    visit(Setting{"", "volume.spacing", "mm", "voxel spacing, in the place of the file's"}.above(0), s.spacing_mm);
}

/// The settings of the scene itself.
template <class Visit, SettingsOf<Scene> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"size", "image.size", "pixels", "width and height of the picture"}
          .within(1, 16384).written("WxH"), s.width, s.height);
    visit(Setting{"mode", "mode", "", "shows the volume, isosurfaces, along each ray the largest, smallest or mean value, or all light added up"}, s.mode);
    visit(Setting{"iso", "iso", "", "adds an isosurface at a value, in the transfer function's colour or another"}
          .written("VALUE[,COLOR][@OPACITY]").kept(SceneForm::surfaces), s.iso);
    visit(Setting{"interpolation", "sampling.interpolation", "",
                  "values between voxels: linear; cubic, of a B-spline through the voxels, or smooth, of one that they are the coefficients of; auto: linear drafts, then cubic, or smooth where there is noise and nothing thin; texture: linear by a GPU's texture units, with weights of 8 fractional bits"},
          s.interpolation);
    visit(Setting{"background", "background", "",
                  "colour behind the volume: a CSS name, #rrggbb or r,g,b; or nothing, or the environment map"}
          .written("COLOR|transparent|probe"), s.output.background, s.output.transparent, s.lighting.probe.background);
}

template <class Visit, SettingsOf<Clip> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"clip-box", "clip.box", "", "keeps a part of the volume, in fractions of its size along its axes"}
          .written("X0,X1,Y0,Y1,Z0,Z1").within(0, 1), s.box);
    visit(Setting{"clip-plane", "clip.planes", "mm", "removes what lies beyond the plane n·x = D, where n points"}
          .written("NX,NY,NZ,D").kept(SceneForm::list), s.planes);
    visit(Setting{"largest", "clip.largest", "",
                  "leaves out what is not connected to the largest piece of what is visible: tables, head rests, specks"},
          s.largest);
}

template <class Visit, SettingsOf<RaySettings> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"step", "sampling.step", "voxels", "distance of the samples along a ray, in units of the smallest voxel size"}
          .within(0.001, 100), s.step_voxels);
    visit(Setting{"classification", "sampling.classification", "",
                  "what meets the transfer function: interpolated values, voxels, or all values that a step passes"},
          s.classification);
    visit(Setting{"compositing", "sampling.compositing", "", "order in which samples are composited"}, s.compositing);
    visit(Setting{"samples-per-pixel", "sampling.samples_per_pixel", "", "rays through each pixel, averaged"}
          .within(1, 256), s.samples_per_pixel);
    visit(Setting{"ray-setup", "sampling.ray_setup", "",
                  "starts rays at the volume's box, or at the rasterised bounds of what is visible; the same picture"},
          s.ray_setup);
    visit(Setting{"early-termination", "sampling.early_termination", "",
                  "remaining transmittance at which a ray stops; 0: never"}
          .within(0, 0.99), s.early_termination);
    visit(Setting{"no-skip-empty", "sampling.no_skip_empty", "", "samples empty space too, as a check of the skipping"},
          s.skip_empty);
}

template <class Visit, SettingsOf<CameraSettings> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"azimuth", "camera.azimuth_deg", "degrees", "turns the camera around the up axis"}
          .within(-36000, 36000), s.azimuth_deg);
    visit(Setting{"elevation", "camera.elevation_deg", "degrees", "raises the camera towards the up axis"}
          .within(-90, 90), s.elevation_deg);
    visit(Setting{"roll", "camera.roll", "degrees", "turns the picture clockwise"}.within(-36000, 36000), s.roll_deg);
    visit(Setting{"fit", "camera.fit", "", "what the camera fits: what is visible, found once, or the whole volume"}, s.fit);
    visit(Setting{"", "camera.fit_centre", "mm", "centre of the ball that was found around what is visible"}, s.fit_centre);
    visit(Setting{"", "camera.fit_radius", "mm", "radius of the ball that was found around what is visible"}
          .above(0), s.fit_radius_mm);
    visit(Setting{"zoom", "camera.fit_scale", "", "1 shows all that the camera fits, 2 from half the distance"}
          .within(1e-9, 1000).kept(SceneForm::reciprocal), s.zoom);
    visit(Setting{"fov", "camera.view_angle_deg", "degrees", "vertical angle of view"}.within(0.1, 170), s.fov_deg);
    visit(Setting{"up", "camera.up", "", "up axis in the world (+z, superior where the file states a frame)"}
          .written("±x|±y|±z|X,Y,Z"), s.up);
    visit(Setting{"projection", "camera.projection", "", "projection of the camera"}, s.projection);
    visit(Setting{"view", "camera.view", "", "looks at the volume from this anatomical side"}, s.view);
    visit(Setting{"eye", "camera.eye", "mm",
                  "position of the camera in the world; with --target, in the place of the orbit"},
          s.eye);
    visit(Setting{"target", "camera.target", "mm", "point in the world that the camera looks at"}, s.target);
    visit(Setting{"camera-matrix", "camera.matrix", "",
                  "camera of another program, in the place of orbit, eye and projection: clip coordinates from the world's, row by row, as OpenGL has them"}
          .written("M11,M12,...,M44"), s.matrix);
    visit(Setting{"aperture", "camera.aperture", "mm",
                  "diameter of the lens: what is out of focus is blurred, in final pictures (at least 64 rays a pixel) and by paths; 0: all is sharp"}
          .within(0, 1e6), s.aperture_mm);
    visit(Setting{"focus", "camera.focus", "mm",
                  "distance from the eye that is in focus (that of the centre of what the camera fits, or of the target)"}
          .above(0), s.focus_mm);
}

template <class Visit, SettingsOf<Lighting> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"shading", "shading.enabled", "", "reflection model of surfaces"}.kept(SceneForm::on_off), s.shading);
    visit(Setting{"ambient", "shading.ambient", "", "ambient reflection: fraction of light that comes from all directions"}
          .within(0, 10), s.ambient);
    visit(Setting{"diffuse", "shading.diffuse", "", "diffuse reflection: fraction of light reflected diffusely"}.within(0, 10), s.diffuse);
    visit(Setting{"specular", "shading.specular", "", "strength of highlights"}.within(0, 10), s.specular);
    visit(Setting{"shininess", "shading.specular_power", "", "exponent of highlights: higher is smaller"}
          .within(0, 10000), s.shininess);
    visit(Setting{"light", "shading.light", "degrees",
                  "light from a direction fixed to the world, along the camera's axis, or from a point in the world (mm)"}
          .written("AZ,EL[,COLOR]|headlight[,COLOR]|at:X,Y,Z[,COLOR]").kept(SceneForm::lights), s.lights);
    visit(Setting{"strength", "lighting.strength", "", "how much of the occlusion is shown"}.within(0, 1), s.strength);
}

template <class Visit, SettingsOf<ProbeSettings> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"probe", "probe", "",
                  "environment map (HDRI) that lights the volume: an equirectangular image file, a built-in one (default of visibility, transport and reference: white), or one of the lights that --light has, in the dark"}
          .written("FILE.hdr|.exr|white|sky|studio|windows|three-point|lights").kept(SceneForm::custom), s.source);
    visit(Setting{"probe-rotation", "probe.rotation", "degrees", "turns the environment map around the up axis; where nothing tells, with the first view of a volume that has an anatomical frame"}
          .within(-36000, 36000).written("DEG"), s.rotation_deg);
    visit(Setting{"probe-exposure", "probe.exposure", "stops",
                  "multiplies the environment map's light by 2 to this power; auto: one from a file until it lights a white ball well"}
          .within(-32, 32).written("STOPS|auto"), s.exposure);
    visit(Setting{"probe-background", "probe.background", "", "shows the environment map behind the volume"}, s.background);
}

template <class Visit, SettingsOf<FloorSettings> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"floor", "floor.show", "",
                  "puts a matte floor under what is visible, which takes its shadow and reflects light; not for modes without light"},
          s.show);
    visit(Setting{"floor-albedo", "floor.albedo", "", "share of the light that the floor reflects"}.within(0, 1), s.albedo);
}

template <class Visit, SettingsOf<IlluminationSettings> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"lighting", "lighting.method", "", "method that computes how much light arrives at a sample"},
          s.method);
    visit(Setting{"surfaces", "lighting.surfaces", "",
                  "light meets particles everywhere, or surfaces where opacity rises steeply (default auto; for mean-radiance none)"}
          .of("spao|visibility|histogram|transport|reference"), s.surfaces);
}

template <class Visit, SettingsOf<SpaoSettings> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"spao-filter", "lighting.filter", "", "how mean opacities over cubes are computed"}.of("spao"), s.filter);
    visit(Setting{"spao-levels", "lighting.levels", "", "shells: cubes of width 1 to 2^N voxels"}
          .within(1, 14).of("spao"), s.levels);
    visit(Setting{"spao-mip-levels", "lighting.mip_levels", "", "mipmaps of the hybrid before its N-buffers"}
          .within(0, 14).of("spao"), s.mip_levels);
    visit(Setting{"spao-normal-factor", "lighting.normal_factor", "",
                  "0: light from all directions, else from those that the surface faces"}
          .within(0, 2).of("spao"), s.normal_factor);
    visit(Setting{"spao-model", "lighting.model", "", "product over shells as published (Kroes, Schut and Eisemann), with each shell's thickness, or per octant"}
          .of("spao"), s.model);
}

template <class Visit, SettingsOf<VisibilitySettings> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"sh-bands", "lighting.bands", "", "bands of spherical harmonics: 2 for 4 coefficients, 4 for 16"}
          .written("2|4").of("visibility"), s.bands);
    visit(Setting{"sh-directions", "lighting.directions", "", "directions in which each node computes visibility"}
          .within(4, 65536).of("visibility"), s.directions);
    visit(Setting{"sh-subsample", "lighting.subsample", "voxels", "distance of the nodes"}
          .written("1|2|4|8").of("visibility"), s.subsample);
    visit(Setting{"sh-traversal", "lighting.traversal", "", "how transmittance along each direction is computed"}
          .of("visibility"), s.traversal);
    visit(Setting{"sh-sampling", "lighting.sampling", "", "one set of directions, or one of M jittered sets for each node"}
          .written("fibonacci|jittered[:M]").of("visibility"), s.sampling);
    visit(Setting{"sh-model", "lighting.model", "", "surfaces lit by Lambert's law at a normal offset, or the model as published (Ritschel 2007)"}
          .of("visibility"), s.model);
    visit(Setting{"sh-window", "lighting.window", "", "damps high bands: less ringing, more error"}
          .of("visibility"), s.window);
    visit(Setting{"sh-storage", "lighting.storage", "", "number type of a stored coefficient"}.of("visibility"), s.storage);
}

template <class Visit, SettingsOf<HistogramSettings> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"hist-radius", "lighting.radius", "voxels", "radius of the spherical neighbourhood of a voxel, in units of the smallest voxel size; 0: proposed from the data"}
          .within(0, 64).of("histogram"), s.radius);
    visit(Setting{"hist-clusters", "lighting.clusters", "", "size of the codebook: histograms that stand for those of all voxels"}
          .within(1, 4096).of("histogram"), s.clusters);
    visit(Setting{"hist-packed-bins", "lighting.packed_bins", "", "bins in which histograms are compared"}
          .within(2, 256).of("histogram"), s.packed_bins);
    visit(Setting{"hist-packing", "lighting.packing", "", "which bins are joined before histograms are compared"}
          .of("histogram"), s.packing);
    visit(Setting{"hist-metric", "lighting.metric", "", "distance of two histograms"}.of("histogram"), s.metric);
    visit(Setting{"hist-path", "lighting.path", "", "how local histograms are computed"}.of("histogram"), s.path);
    visit(Setting{"hist-subsample", "lighting.subsample", "voxels", "distance of the voxels with a histogram"}
          .written("1|2|4").of("histogram"), s.subsample);
    visit(Setting{"hist-model", "lighting.model", "", "light is exp(-r O) of occlusion O, or 1 - O as published (Ropinski et al. 2008)"}
          .of("histogram"), s.model);
    visit(Setting{"hist-effects", "lighting.effects", "", "effects shown: some of ao (ambient occlusion), bleeding (colour), scattering, glow (emission)"}
          .written("ao,bleeding,scattering,glow").of("histogram"), s.effects);
    visit(Setting{"hist-anisotropy", "lighting.anisotropy", "",
                  "anisotropy g of scattering (Henyey and Greenstein): below 0 backwards, above 0 forwards"}
          .within(-0.95, 0.95).of("histogram"), s.anisotropy);
    visit(Setting{"glow", "lighting.glow", "", "emission: values that glow, and how strongly (1: not at all)"}
          .written("FILE|LO:HI=STRENGTH").of("histogram"), s.emission);
    visit(Setting{"cache", "lighting.cache", "", "folder where prepared volumes are kept (the user's cache), or none"}
          .written("DIR|none").of("histogram"), s.cache);
    visit(Setting{"hist-channel", "lighting.channel", "", "of several channels the one whose values are counted, from 1; 0: local histograms are of one alone"}
          .within(0, 8).of("histogram"), s.channel);
}

template <class Visit, SettingsOf<TransportSettings> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"transport-grid", "lighting.grid", "cells", "cells of the lighting grid along the volume's longest axis"}
          .within(4, 256).of("transport"), s.grid);
    visit(Setting{"transport-directions", "lighting.directions", "", "discrete ordinates: directions of scattered light, other ones in each iteration"}
          .within(6, 65536).of("transport"), s.directions);
    visit(Setting{"transport-first-directions", "lighting.first_directions", "", "directions of uncollided light (light that is not yet scattered)"}
          .within(6, 65536).of("transport"), s.first_directions);
    visit(Setting{"transport-error", "lighting.error", "", "stops when an iteration changes the light by less than this relative error"}
          .above(0).written("E").of("transport"), s.error);
}

template <class Visit, SettingsOf<ReferenceSettings> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"reference-rays", "lighting.rays", "", "rays or paths from every voxel; for radiance, paths through every pixel"}
          .within(1, 65536).of("reference"), s.rays);
    visit(Setting{"reference-quantity", "lighting.quantity", "", "visibility averaged over all directions (fields), over the outward hemisphere, or cosine-weighted; in spherical harmonics; or light by path tracing: mean-radiance (fields; also called fluence), radiance (pictures)"}
          .of("reference"), s.quantity);
    visit(Setting{"reference-medium", "lighting.medium", "", "extinction constant in each voxel, or interpolated"}
          .of("reference"), s.medium);
    visit(Setting{"reference-start", "lighting.start", "half voxels", "distance from a voxel's centre at which rays begin"}
          .within(0, 1000).written("HALF_VOXELS").of("reference"), s.start_half_voxels);
    visit(Setting{"reference-subsample", "lighting.subsample", "", "rays from every Nth voxel per axis only"}
          .within(1, 64).of("reference"), s.subsample);
    visit(Setting{"reference-time", "lighting.time", "seconds", "stops path tracing of radiance and mean radiance after this time"}
          .above(0).written("S").of("reference"), s.time_s);
    visit(Setting{"reference-error", "lighting.error", "",
                  "stops path tracing of radiance and mean radiance at this standard error relative to the picture's brightness"}
          .above(0).written("E").of("reference"), s.error);
}

template <class Visit, SettingsOf<ScatteringSettings> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"bounces", "lighting.bounces", "", "how often light is scattered beyond the first time"}
          .within(0, 1e6).written("N|unlimited").of("transport|reference"), s.bounces);
    visit(Setting{"albedo-max", "lighting.albedo_max", "",
                  "largest albedo, where light is scattered more than once"}
          .within(0, 1).of("transport|reference"), s.albedo_max);
    visit(Setting{"seed", "lighting.seed", "", "seed of all random numbers: paths, and how directions are turned"}
          .within(0, 4294967295.0).of("transport|reference"), s.seed);
}

template <class Visit, SettingsOf<ToneMap> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"color", "color", "",
                  "composites decoded sRGB colours as linear light, or as they are (as VTK does)"},
          s.color);
    visit(Setting{"tone", "output.tone", "", "curve that bends bright light into what a screen can show"}, s.tone);
    visit(Setting{"exposure", "output.exposure", "stops", "multiplies the light by 2 to this power, before the curve"}
          .within(-32, 32).written("STOPS"), s.exposure_stops);
}

/// Scene files only: no flags.
template <class Visit, SettingsOf<SliceSettings> S>
void describe(Visit&& visit, S& s) {
    visit(Setting{"", "slices.layout", "", "the viewer shows the volume, with three linked slices, or one of them large"}, s.layout);
    visit(Setting{"", "slices.at", "mm", "point in the world that the viewer's slices pass through"}, s.at_mm);
    visit(Setting{"", "slices.centre", "mm", "point in the world that is in the middle of the viewer's slices"}, s.centre_mm);
    visit(Setting{"", "slices.zoom", "", "1 shows the whole slice"}.within(0.01, 1000), s.zoom);
    visit(Setting{"", "slices.window", "", "grey levels of slices (the 1st to the 99.9th percentile)"}
          .written("CENTER,WIDTH"), s.window);
    visit(Setting{"", "slices.sampling", "", "interpolation of slices between voxels"}, s.sampling);
    visit(Setting{"", "slices.colors", "", "slices in grey, or with the transfer function's colours over it"}, s.colors);
    visit(Setting{"", "slices.side", "", "where slices show the patient's left: at the right, or at the left"}, s.side);
    visit(Setting{"", "slices.outlines", "", "shows in the volume where the slices lie"}, s.outlines);
    visit(Setting{"", "slices.labels", "", "opacity of labels over slices"}.within(0, 1), s.labels);
}

/// Calls group(title, settings) for each struct of settings in a scene, in the order of --help.
template <class Group, SettingsOf<Scene> S>
void for_each_group(Group&& group, S& scene) {
    group("Volume", scene.read);
    group("Volume as stated", scene.stated);
    group("Labels", scene.labels);
    group("Transfer function", scene.transfer);
    group("Picture", scene);
    group("Clipping", scene.clip);
    group("Sampling", scene.sampling);
    group("Camera", scene.camera);
    group("Shading", scene.lighting);
    group("Light probe", scene.lighting.probe);
    group("Floor", scene.lighting.floor);
    group("Lighting", scene.illumination);
    group("Lighting by spao", scene.illumination.spao);
    group("Lighting by visibility", scene.illumination.visibility);
    group("Lighting by histogram", scene.illumination.histogram);
    group("Lighting by transport", scene.illumination.transport);
    group("Lighting by reference", scene.illumination.reference);
    group("Scattering", scene.illumination.scattering);
    group("Output", scene.output);
    group("Slices of the viewer", scene.slices);
}

/// Calls visit(Setting, field...) for every setting of a scene.
template <class Visit, SettingsOf<Scene> S>
void for_each_setting(Visit&& visit, S& scene) {
    for_each_group([&](std::string_view, auto& settings) { describe(visit, settings); }, scene);
}

/// Texts of settings by the names of their flags, as a user gave them.
using GivenSettings = std::map<std::string, std::string, std::less<>>;

/// Sets what is given, which wins over what the scene says: of settings that replace each other, the one that is given
/// puts away the scene's. "" takes back an optional one. `written` tells how the user wrote a setting ("--step 0"), for
/// messages. Names that are none are passed over. Throws Error{usage}.
CHIARO_EXPORT void set_by_name(Scene& scene, const GivenSettings& given,
                               const std::function<std::string(std::string_view name, std::string_view value)>& written);

}  // namespace chiaro
