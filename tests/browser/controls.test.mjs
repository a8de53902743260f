// What the viewer can be told, and where each way of telling it is shown: a test by its name, a line of
// docs/viewer.md, or (in brackets) why there is nothing to show. No field may be empty, and what is named must be there.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";

const cross = "one crosshair: a click in a slice", drags = "right drag, shift drag and Ctrl with the wheel", fingers = "with fingers: a tap places the crosshair", rows = "the section of the slices: place by number", back = "slices come back with a scene and after a reload";
const two = "with fingers: two taps measure", byKeys = "by keys alone: kinds by arrows", dragged = "a point is dragged, in a slice and on the volume", keptMarks = "marks are kept in the scene, in undo and over a reload", regions = "a ball and a box hold the voxels", taps = "with fingers: two taps";
const opening = "(opening is no edit)", button = "every button, field and slider of every part", byHand = "the volume by keys and by fingers", scenes = "save, load, save", steps = "a dragged point moves in the next frame", same = "(nothing is changed)", told = "within a page of an origin", far = "(chosen by the server)";
const byMouse = "by mouse: a shape is drawn", shapeKeys = "by keys: shapes are added", shapeTouch = "with fingers: a shape is drawn", bends = "the curve over the gradient: points are added", keptShapes = "shapes and curve come with a scene";
const controls = {
  //                   mouse, keyboard, touch, scene file, undo, docs
  "turn, move and zoom": ["right drag: window; wheel: zoom", byHand, byHand, "the page's camera is the scene's", "right drag: window; wheel: zoom", "turns; middle button or Shift: moves"],
  "window of the volume": ["right drag: window; wheel: zoom", "every control is reached by Tab", button, scenes, "right drag: window; wheel: zoom", "window: right widens, up raises"],
  "points and colours": [steps, "every control is reached by Tab", "a finger that rests reads the value", scenes, steps, "Click for a new point"],
  "shapes over value and gradient": [byMouse, shapeKeys, shapeTouch, keptShapes, byMouse, "Drag a box over what is to be seen"],
  "curve over the gradient": [bends, bends, shapeTouch, keptShapes, bends, "opacity over the gradient alone"],
  "adjust on the picture": ["Adjust picks the value", "a tool's key switches to it", "a finger that rests reads the value", scenes, "Adjust picks the value", "takes the value that is seen"],
  "looks": ["a threshold of shutters, a shape, a look", "every control is reached by Tab", button, scenes, "a walk: start empty", "in the list of looks"],
  "names of peaks": ["a peak is named by a double click", "a peak is named by a double click", button, "a peak is named by a double click", "a peak is named by a double click", "names it"],
  "light": ["each method is sent", "every control is reached by Tab", button, scenes, "each method is sent", "Occlusion"],
  "turn of the light": ["the ball turns the probe", "every control is reached by Tab", button, scenes, "a walk: start empty", "drag the ball to turn it"],
  "cutting": ["a face of the box is pulled", "a plane is pulled by its handle", button, scenes, "a plane is pulled by its handle", "*Add a plane*"],
  "compare": ["Compare shows the reference", "Compare shows the reference", button, same, same, "**Compare** puts"],
  "save the picture": ["the picture is saved in the wanted size", "every control is reached by Tab", button, "a saved scene gives the same pixels again", same, "A saved picture carries its settings"],
  "a link": ["a link opens the same state", button, button, "a link opens the same state", "a link opens the same state", "*Copy a link to this*"],
  "the page around": [told, "(a program's)", "(a program's)", told, told, "`postMessage`"],
  "far away": ["behind 50 ms and 5 Mbit/s", far, far, far, far, "`scripts/far_away` measures"],
  "writing goes on": ["writing goes on after a reload", button, button, "(a film is no scene)", same, "goes on where it was after a reload"],
  "limits of what is sent": ["more than is allowed is refused", "(nothing to press)", "(nothing to press)", opening, opening, "at most 4 GiB a volume"],
  "layout": ["the parts that slices need are loaded", "layouts, letters and sides", fingers, back, rows, "`S` puts three slices beside the volume"],
  "one slice large": ["layouts, letters and sides", "layouts, letters and sides", button, "layouts, letters and sides", rows, "double click, `Enter`"],
  "crosshair": [cross, cross, fingers, back, cross, "places the crosshair"],
  "next slice": [cross, cross, fingers, back, cross, "wheel, slider, `Page Up`"],
  "grey levels": [drags, rows, button, back, rows, "right widens, up raises the centre"],
  "pan and zoom of slices": [drags, cross, fingers, back, cross, "Ctrl and wheel, `+`, `-`"],
  "colours, voxels, side, outlines": [rows, rows, button, back, rows, "the volume's colours over the grey"],
  "oblique slice": ["an oblique slice follows the clip plane", cross, fingers, "an oblique slice follows the clip plane", "(it is the clip plane's)", "*Along the plane*"],
  "value under the pointer": ["a nearest slice shows and tells the file's own numbers", "(the crosshair's own place is in the panel)", fingers, "(nothing is changed)", "(nothing is changed)", "the value as the file has it"],
  "save a slice": ["a slice is saved as a figure", button, button, "(nothing is changed)", "(nothing is changed)", "*Save as a picture*"],
  "distance": ["distances between edges are right", byKeys, two, keptMarks, byKeys, "Distance, Angle"],
  "path": [keptMarks, byKeys, taps, keptMarks, keptMarks, "double click or `Enter` ends it"],
  "angle": ["distances between edges are right", byKeys, taps, keptMarks, keptMarks, "arm, corner, arm"],
  "ball and box": [regions, regions, taps, keptMarks, keptMarks, "voxels whose centres lie inside"],
  "profile": ["a profile has the values along its line", byKeys, taps, keptMarks, keptMarks, "*Save the profile as CSV*"],
  "arrow and text": [keptMarks, keptMarks, taps, keptMarks, keptMarks, "where it points, then where it begins"],
  "points moved": [dragged, byKeys, two, keptMarks, dragged, "dragged, moved by arrow keys"],
  "snap": ["distances between edges are right", byKeys, taps, "(a habit of the browser's, not of the scene)", "(a habit of the browser's, not of the scene)", "*Snap to edges*"],
  "table as CSV": [keptMarks, button, button, "(nothing is changed)", "(nothing is changed)", "*Save as CSV*"],
  "saved figures": ["a saved figure carries what was measured", button, button, "a saved figure carries what was measured", "(nothing is changed)", "drawn into saved pictures"],
  "open a file": ["a file that is dropped is sent", button, button, opening, opening, "a file or a folder of this computer"],
  "open a folder": ["a folder is chosen by a button", button, button, opening, opening, "else the folder, as slices"],
  "cancel": ["progress and cancel", button, button, opening, opening, "with progress and *Cancel*"],
  "recent volumes": ["the page without a volume", "the page without a volume", button, opening, opening, "what was open before"],
  "keys of a film": ["keys are dragged and removed", "two keys make a film", "with fingers: the strip stands over", "two keys make a film", "keys are dragged and removed", "Keys are dragged, or moved"],
  "play": ["play shows what is between", "play shows what is between", button, "(nothing is changed)", "(nothing is changed)", "*Play* plays"],
  "turntable": ["a turntable in one click", button, "with fingers: the strip stands over", "two keys make a film", "keys are dragged and removed", "*Turntable* sets four keys"],
  "write a film": ["a turntable in one click", button, button, "two keys make a film", "(nothing is changed)", "in the background, with progress"],
  "channels shown": ["channels: a row each", "channels: a row each", "channels: legible in both themes, and with fingers", "channels: a reload, and a scene", "channels: a row each", "the eye shows or hides it"],
  "channels' colour, gain, window": ["channels: colour, gain by number", "channels: colour, gain by number", "channels: legible in both themes, and with fingers", "channels: a reload, and a scene", "channels: the graph is of the edited one", "its colour, its name, its gain, its window"],
  "labels shown": ["labels: one alone by Alt and click", "labels: one alone by Alt and click", "labels: legible in both themes, and with fingers", "labels: colour, tint and opacity", "labels: listed with their share", "*As in the table* takes every change back"],
  "labels found": ["labels: found by a part of the name", "labels: found by a part of the name", button, "(a search is no edit)", "(a search is no edit)", "*Find a label* takes"],
  "labels' colour, tint, opacity": ["labels: colour, tint and opacity", "labels: colour, tint and opacity", button, "labels: colour, tint and opacity", "labels: listed with their share", "*Tint* and *Opacity* below are its own"],
  "labels in the picture and slices": ["labels: a click in the picture chooses", "(the list chooses by keys)", button, "labels: colour, tint and opacity", same, "In slices labels lie over the grey"],
  "labels opened": ["labels: opened from the server", "labels: opened from the server", button, "labels: opened from the server", "labels: opened from the server", "*Labels on the server* under"],
  "go on where it was": ["a page that was closed by mistake", button, button, "killed with -9 in the middle of an edit", "killed with -9 in the middle of an edit", "killed in the middle of an edit"],
};

test("each control is told by mouse, keys and fingers, kept, undone and documented", () => {
  const folder = new URL(".", import.meta.url), titles = readdirSync(folder).filter((name) => /^viewer_.*\.test\.mjs$/.test(name)).map((name) => readFileSync(new URL(name, folder), "utf8")).join("\n");
  const docs = readFileSync(new URL("../../docs/viewer.md", folder), "utf8").replace(/\s+/g, " "), missing = [];
  for (const [control, fields] of Object.entries(controls)) {
    assert.equal(fields.length, 6, control);
    fields.forEach((field, i) => {
      const known = /^\(.{5,}\)$/.test(field) ? i < 5 : i === 5 ? docs.includes(field) : new RegExp(`(test|visit)\\(["\`]${field.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")}`).test(titles);
      if (!known) missing.push(`${control}: ${["mouse", "keyboard", "touch", "scene file", "undo", "docs"][i]}: ${field || "nothing"}`);
    });
  }
  assert.deepEqual(missing, []);
});
