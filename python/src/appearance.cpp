// Transfer functions and environment maps.
#include "binding.h"

namespace chiaro::python {
namespace {

using Point = std::tuple<double, double, double, double, double, std::string>;

TransferFunction made_of(const std::vector<Point>& points, bool linear, double unit, bool unit_is_mm,
                         const std::string& name) {
    TransferFunction tf;
    for (const auto& [value, r, g, b, opacity, named] : points) tf.points.push_back({value, {r, g, b}, opacity, named});
    tf.rgb_space = linear ? RgbSpace::linear : RgbSpace::srgb;
    tf.opacity_unit = unit, tf.opacity_unit_is_mm = unit_is_mm, tf.name = name;
    validate(tf);
    return tf;
}

std::vector<Point> points_of(const TransferFunction& tf) {
    std::vector<Point> points;
    for (const ControlPoint& p : tf.points)
        points.emplace_back(p.value, p.rgb[0], p.rgb[1], p.rgb[2], p.opacity, p.name);
    return points;
}

/// Statistics that stretch a function over [low, high] exactly.
Statistics spanning(double low, double high) {
    Statistics s;
    s.min = s.p1 = low, s.max = s.p99 = s.p999 = high, s.p50 = (low + high) / 2;
    return s;
}

py::tuple told(const TransferFile& file) {
    return py::make_tuple(file.function, file.stretched, file.notes, file.format);
}

py::tuple load(const std::string& name, const VolumeHandle* volume, double low, double high) {
    return told(read_transfer_file(name, volume ? measure(*volume->volume) : spanning(low, high)));
}

Probe probe_of(py::buffer array) {
    const py::buffer_info info = array.request();
    const auto* first = static_cast<const float*>(info.ptr);
    return {int(info.shape[1]), int(info.shape[0]), std::vector<float>(first, first + info.size)};
}

Array<float> rgb_of(const Probe& probe) {
    const auto rgb = probe.rgb();
    return {{rgb.begin(), rgb.end()}, {probe.height(), probe.width(), 3}};
}

}  // namespace

void add_appearance(py::module_& module) {
    py::class_<TransferFunction>(module, "TransferFunction")
        .def(py::init(&made_of))
        .def_property_readonly("points", points_of)
        .def_readonly("opacity_unit", &TransferFunction::opacity_unit)
        .def_readonly("opacity_unit_is_mm", &TransferFunction::opacity_unit_is_mm)
        .def_readonly("name", &TransferFunction::name)
        .def_property_readonly("is_linear", [](const TransferFunction& tf) { return tf.rgb_space == RgbSpace::linear; })
        .def("windowed",
             [](const TransferFunction& tf, double center, double width) { return with_window(tf, center, width); })
        .def("evaluate",
             [](const TransferFunction& tf, double value) {
                 const ControlPoint p = evaluate(tf, value);
                 return py::make_tuple(p.rgb[0], p.rgb[1], p.rgb[2], p.opacity);
             })
        .def("to_json", [](const TransferFunction& tf) { return to_json(tf); })
        .def("to_paraview_json", [](const TransferFunction& tf) { return to_paraview_json(tf); })
        .def("__eq__", [](const TransferFunction& a, const TransferFunction& b) { return a == b; });
    module.def("load_transfer", load);
    module.def("parse_color", parse_color);
    module.def("list_presets", [] {
        py::list all;
        for (const PresetInfo& p : list_presets())
            all.append(py::make_tuple(p.name, p.modality, p.sentence, p.stretched));
        return all;
    });
    py::class_<Probe>(module, "Probe").def(py::init<>()).def(py::init(&probe_of)).def_property_readonly("rgb", rgb_of);
    module.def("load_probe", py::overload_cast<const std::string&>(load_probe));
    module.def("list_probes", [] {
        py::list all;
        for (const ProbeInfo& p : list_probes()) all.append(py::make_tuple(p.name, p.sentence));
        return all;
    });
}

}  // namespace chiaro::python
