// The words of slices and measurements: they come with these parts.
import { words } from "./texts.js";

export const sliceWords = {
  title: "Slices", layout: words.slices.layout, layoutTip: "What stands beside the volume.", layouts: { volume: "Volume alone", linked: "With three slices" },
  names: { axial: "Axial", coronal: "Coronal", sagittal: "Sagittal", oblique: "Along the plane" }, across: (axis) => `Across ${axis}`, slice: (name) => `Slice: ${name}`, of: (i, n) => `${i} of ${n}`,
  enlarge: "Large", back: "Back to all", crosshair: "Crosshair", crosshairTip: "Where all slices meet, in the file's frame.", pan: "Slices moved", zoom: "Zoom of slices", outside: "outside", voxel: (v) => `voxel ${v.join(", ")}`,
  window: "Grey levels", windowTip: "Black and white of the slices. A right drag on one does the same.", colours: "Colours", coloursTip: "Grey, or the colours of the volume over it.", grey: "Grey", transfer: "Of the volume",
  sampling: "Voxels", samplingTip: "Interpolated, or as they are.", linear: "Interpolated", nearest: "As they are", side: "Side", sideTip: "Where the patient's left is.", sides: { radiological: ["Radiological", "left at the right"], neurological: ["Neurological", "left at the left"] },
  save: "Save as a picture", outlines: "Shown in the volume", outlinesTip: "Outlines of the slices.",
};

export const markWords = {
  title: "Measurements", tool: "Measure", none: "None", some: (n) => (n === 1 ? "1" : String(n)), kinds: { distance: "Distance", polyline: "Path", angle: "Angle", ball: "Ball", box: "Box", profile: "Profile", arrow: "Arrow", text: "Text" },
  hints: { distance: "Click two points, in a slice or on the volume.", polyline: "Click point by point; a double click or Enter ends the path.", angle: "Click an arm, the corner, the other arm.", ball: "Press in the centre and drag to the rim: the values inside.", box: "Drag from corner to corner: the values inside, one slice thick.",
    profile: "Click two points: the values along the line.", arrow: "Click where it points, then where it begins.", text: "Click a place." },
  added: (name) => name, changed: "Measurement", moved: "Point moved", removed: "Measurement removed", named: "Name of a measurement", pointOf: (name, n) => `${name}, point ${n}`, nameOf: (name) => `Name of ${name}`, nothingThere: "Nothing is seen there.", show: "Show",
  snap: "Snap to edges within", snapTip: "Points go to the half-value surface that is nearest, at most so many pixels away; 0: they stay where they are put.", atCrosshair: "Point at the crosshair", atCrosshairTip: "Space in a slice does the same.", done: "End the path",
  csv: "Save as CSV", clear: "Remove all", file: "measurements.csv", profileFile: "profile.csv", profileCsv: "Save the profile as CSV", points: (unit, world) => `Points, ${unit}${world === "unknown" ? "" : `, ${world}`}`,
  count: "Voxels", mean: "Mean", deviation: "Standard deviation", range: "Range", median: "Median", quartiles: "Quartiles", tails: "5 % and 95 %", volume: "Volume of the voxels", exactVolume: "Exact volume", radius: "Radius", histogram: "Histogram of the values", profileOf: (low, high) => `Values along the line, ${low} to ${high}`,
};

export const channelWords = {
  title: "Channels", channel: (n) => `Channel ${n}`, gain: "Gain", solo: "One channel alone", shown: "Channel shown", show: "Show", hide: "Hide", eyeTip: "Shown or not. With Alt: this one alone, and all again.", editTip: "Colour and opacity below are of this channel.", windowTip: "Moves and stretches the channel's points.",
};
export const labelWords = {
  title: "Labels", search: "Find a label", showAll: "Show all", hideAll: "Hide all", onlyFound: "Only these", reset: "As in the table", solo: "One label alone", shown: "Label shown", show: "Show", hide: "Hide", eyeTip: "Shown or not. With Alt: this one alone, and all again.",
  tint: "Tint", tintTip: "How much of the volume's colour the label's replaces.", opacityTip: "Multiplies the opacity of the label's voxels.", others: (n) => `${n} more: type a part of the name.`, none: "No label of this name.",
  overSlices: "Labels", overSlicesTip: "Opacity of labels over the slices.",
};

export const momentWords = {
  title: "Moment", play: "Play the moments", pause: "Pause", of: (i, n) => `${i + 1} of ${n}`, went: "Another moment",
};
export const filmWords = {
  title: "Film", time: "Time in the film", add: "Add a key", removed: "Key removed", loaded: "Film loaded", moved: "Key moved", turntable: "Turntable", go: "Go there", update: "Replace", play: "Play", pause: "Pause", key: (n) => `Key ${n}`,
  fps: "Frames a second", perSecond: (n) => `${n} a second`, save: "Save the film", writing: "Writing the film", formats: { mp4: "As MP4", webm: "As WebM", png: "As PNGs, in an archive" }, file: "As keyframes, for chiaro render --film",
  hint: "Change the picture and add another key: the film goes from one to the next. Turntable sets four, once around.",
  needsTwo: "A film needs two keys: add one, change the picture, add another.", tooMany: "The film has more keys than can be sent at once; save its keyframes and use chiaro render --film.",
};

export const gradientWords = {
  title: words.gradients, shapes: { rectangle: "Rectangle", ellipse: "Ellipse", triangle: "Triangle" }, curve: "Curve", shape: "Shape", add: (name) => `Add: ${name}`, added: (name) => `New ${name.toLowerCase()}`, changed: (name) => name, removed: (name) => `Remove: ${name}`,
  tips: { rectangle: "Shows what has these values and gradients.", ellipse: "Most in its middle, nothing at its border.", triangle: "An edge between two kinds of matter: most in its middle, wider where it is steeper.", curve: "Opacity over the gradient alone." },
  hint: "Drag a box over what is to be seen: flat matter lies below, edges are arches above it.", volumeOnly: "It is seen in Volume alone.", counting: "Counting", close: "Close", open: "Show", value: words.value, gradient: "Gradient", opacity: words.opacity, remove: words.remove,
  numbered: (name, n) => `${name} ${n}`, shapeText: (values, gradients, opacity) => `values ${values}, gradients ${gradients}, opacity ${opacity}`, pointText: (opacity, gradient) => `opacity ${opacity} at ${gradient}`,
  sides: { value: ["from value", "to value"], magnitude: ["from gradient", "to gradient"] }, sideOf: (name, side) => `${name}, ${side}`, point: "Point of the opacity by gradient", per: (unit, length) => (unit ? `${unit}/${length}` : `per ${length}`), voxel: "voxel",
  says: (shapes, curve) => [shapes ? `${shapes} ${shapes === 1 ? "shape" : "shapes"}` : "", curve ? "a curve" : ""].filter(Boolean).join(", "),
};

export const openWords = {
  path: "Path", pathHint: "Path of a file or folder, or sample:NAME",
  otherFolders: "The folders that Chiaro was started in or with (--data), and that of its file. A file of another folder can be sent, or opened by chiaro view FILE.",
};
