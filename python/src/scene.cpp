// Scenes and settings: all that is known of a setting comes from <chiaro/describe.h>.
#include <algorithm>

#include "binding.h"

namespace chiaro::python {
namespace {

template <class T>
struct Inner {
    using type = T;
    static constexpr bool is_optional = false;
};
template <class T>
struct Inner<std::optional<T>> {
    using type = T;
    static constexpr bool is_optional = true;
};

/// In Python's words: numbers, truths, names, tuples; else the text of the flag.
py::object value(const Setting& s, const bool& field) {
    const std::string text = value_text(s, field);
    if (s.form.find('|') != s.form.npos) return py::str(text);
    return py::bool_(text == "true");
}
py::object value(const Setting&, const int& field) { return py::int_(field); }
py::object value(const Setting&, const std::uint64_t& field) { return py::int_(field); }
py::object value(const Setting&, const double& field) { return py::float_(field); }
py::object value(const Setting&, const std::string& field) {
    return field.empty() ? py::object(py::none()) : py::str(field);
}
py::object value(const Setting&, const Vec3& v) { return py::make_tuple(v.x, v.y, v.z); }
py::object value(const Setting&, const std::pair<double, double>& v) { return py::make_tuple(v.first, v.second); }
py::object value(const Setting&, const std::array<int, 3>& v) { return py::tuple(py::cast(v)); }
py::object value(const Setting&, const std::array<double, 6>& v) { return py::tuple(py::cast(v)); }
py::object value(const Setting&, const Matrix4& v) { return py::tuple(py::cast(v)); }
py::object value(const Setting&, const ProbeExposure& field) {
    return field.stops ? py::object(py::float_(*field.stops)) : py::object(py::str("auto"));
}
py::object value(const Setting&, const int& width, const int& height) { return py::make_tuple(width, height); }
py::object value(const Setting&, const std::vector<ClipPlane>& planes) {
    py::list all;
    for (const ClipPlane& p : planes) all.append(py::make_tuple(p.normal.x, p.normal.y, p.normal.z, p.d));
    return all;
}
py::object value(const Setting&, const std::vector<IsoSurface>& surfaces) {
    py::list all;
    for (const IsoSurface& s : surfaces) all.append(to_text(s));
    return all;
}
py::object value(const Setting&, const std::vector<Light>& lights) {
    py::list all;
    for (const Light& light : lights) all.append(to_text(light));
    return all;
}
py::object value(const Setting& s, const auto&... fields) { return py::str(value_text(s, fields...)); }
template <class T>
py::object value(const Setting& s, const std::optional<T>& field) {
    return field ? value(s, *field) : py::none();
}

/// What a stub needs to know: number, integer, switch, choice, text, numbers (how many), list; else form.
template <class Field>
std::string kind(const Setting& s, const Field&) {
    using T = typename Inner<Field>::type;
    const bool is_choice = s.form.find('|') != s.form.npos;
    if constexpr (Named<T>) return "choice";
    if constexpr (std::is_same_v<T, bool>) return is_choice ? "choice" : "switch";
    if constexpr (std::is_same_v<T, int> || std::is_same_v<T, std::uint64_t>) return "integer";
    if constexpr (std::is_same_v<T, double>) return "number";
    if constexpr (std::is_same_v<T, std::string>) return "text";
    if constexpr (std::is_same_v<T, Vec3> || std::is_same_v<T, std::array<int, 3>>) return "numbers 3";
    if constexpr (std::is_same_v<T, std::pair<double, double>>) return "numbers 2";
    if constexpr (std::is_same_v<T, std::array<double, 6>>) return "numbers 6";
    if constexpr (std::is_same_v<T, Matrix4>) return "numbers 16";
    if (s.repeats()) return "list";
    return "form";
}
std::string kind(const Setting&, const int&, const int&) { return "numbers 2"; }
std::string kind(const Setting&, const auto&...) { return "form"; }

template <class Field>
bool may_be_none(const Field&) {
    return Inner<Field>::is_optional || std::is_same_v<Field, std::string>;
}
bool may_be_none(const auto&...) { return false; }

template <class Field>
std::vector<std::string> choices(const Setting& s, const Field&) {
    std::vector<std::string> all;
    using T = typename Inner<Field>::type;
    if constexpr (Named<T>) {
        for (const std::string_view name : names_of(T{})) all.emplace_back(name);
    } else if (s.form.find('|') != s.form.npos) {
        for (std::size_t begin = 0; begin <= s.form.size();) {
            const std::size_t end = std::min(s.form.find('|', begin), s.form.size());
            all.emplace_back(s.form.substr(begin, end - begin));
            begin = end + 1;
        }
    }
    return all;
}
std::vector<std::string> choices(const Setting&, const ProbeExposure&) { return {}; }  // stops, or auto
std::vector<std::string> choices(const Setting&, const auto&...) { return {}; }

std::string python_name(std::string_view flag) {
    std::string name(flag);
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

py::list settings() {
    py::list all;
    const Scene defaults;
    for_each_group(
        [&](std::string_view title, const auto& group) {
            describe(
                [&](const Setting& s, const auto&... fields) {
                    if (s.name.empty()) return;
                    py::dict told;
                    told["name"] = python_name(s.name), told["flag"] = s.name, told["key"] = s.key;
                    told["group"] = title, told["unit"] = s.unit, told["sentence"] = s.sentence;
                    told["form"] = s.form.empty() ? form_of(fields...) : std::string(s.form);
                    told["range"] = range_of(s), told["methods"] = s.methods, told["repeats"] = s.repeats();
                    told["default"] = value(s, fields...), told["kind"] = kind(s, fields...);
                    told["choices"] = choices(s, fields...), told["optional"] = may_be_none(fields...);
                    all.append(told);
                },
                group);
        },
        defaults);
    return all;
}

Scene with_settings(const Scene& scene, const std::map<std::string, std::string>& given) {
    GivenSettings by_flag;
    for (const auto& [name, text] : given) {
        std::string flag = name;
        std::replace(flag.begin(), flag.end(), '_', '-');
        by_flag.emplace(std::move(flag), text);
    }
    Scene changed = scene;
    set_by_name(changed, by_flag, [](std::string_view name, std::string_view text) {
        return python_name(name) + "=" + std::string(text);
    });
    return changed;
}

std::pair<Scene, std::vector<std::string>> parse(const std::string& json, const std::string& folder) {
    std::vector<std::string> unknown;
    Scene scene = parse_scene(json, folder, {}, unknown);
    for (std::string& key : unknown) key.insert(0, "unknown key ");
    return {std::move(scene), std::move(unknown)};
}

std::pair<Scene, std::vector<std::string>> read(const std::string& file, const std::string& data) {
    std::vector<std::string> notes;
    Scene scene = read_scene(file, data, notes);
    return {std::move(scene), std::move(notes)};
}

/// Name, gain, whether it is shown, and a transfer function or None, of each channel in turn.
using ChannelRow = std::tuple<std::string, double, bool, std::optional<TransferFunction>, std::string>;

Scene with_channels(Scene scene, const std::vector<ChannelRow>& rows) {
    scene.channels.clear();
    for (const auto& [name, gain, show, transfer, source] : rows) {
        ChannelSettings& channel = scene.channels.emplace_back(ChannelSettings{.name = name});
        channel.gain = gain, channel.show = show;
        channel.transfer.points = transfer, channel.transfer.source = source;
    }
    return scene;
}

/// Labels that are in memory; `table`: a file's name, or the text of one where `is_text`.
Scene with_labels(Scene scene, const VolumeHandle& labels, const std::string& name, const std::string& table,
                  bool is_text, py::object report) {
    scene.labels.loaded = result_of({report}, [&](Progress& progress, News&) {
        std::optional<LabelTable> names;
        if (!table.empty()) names = is_text ? parse_label_table(table, "label_table") : read_label_table(table);
        return std::make_shared<const LabelVolume>(make_labels(*labels.volume, names ? &*names : nullptr, progress));
    });
    scene.labels.source = name, scene.labels.table.clear();
    return scene;
}

}  // namespace

py::object value_of(const Scene& scene, const std::string& name) {
    py::object found;
    for_each_setting(
        [&](const Setting& s, const auto&... fields) {
            if (!s.name.empty() && python_name(s.name) == name) found = value(s, fields...);
        },
        scene);
    if (!found) throw py::attribute_error(name);
    return found;
}

void add_scene(py::module_& module) {
    py::class_<Scene>(module, "Scene")
        .def(py::init([](const std::string& volume) { return scene_of_volume(volume); }))
        .def("with_settings", with_settings)
        .def("with_transfer",
             [](Scene scene, const TransferFunction& function) {
                 validate(function);
                 scene.transfer.points = function;
                 scene.transfer.source.clear();
                 scene.transfer.opacity_unit.reset(), scene.transfer.opacity_unit_mm.reset();
                 return scene;
             })
        .def("with_probe",
             [](Scene scene, const Probe& probe) {
                 scene.lighting.probe.source.clear();
                 scene.lighting.loaded_probe = probe;
                 return scene;
             })
        .def("with_channels", with_channels)
        .def("with_labels", with_labels)
        .def("without_labels",
             [](Scene scene) {
                 scene.labels = {};
                 return scene;
             })
        .def("with_volume",
             [](Scene scene, const std::string& volume) {
                 scene.volume = volume;
                 return scene;
             })
        .def("with_camera_of",
             [](Scene scene, const Scene& other) {
                 scene.camera = other.camera;
                 return scene;
             })
        .def("value", value_of)
        .def("to_json",
             [](const Scene& scene, const std::string& folder) {
                 return to_json(folder.empty() ? scene : seen_from(scene, folder));
             })
        .def_readonly("volume", &Scene::volume)
        .def_property_readonly("points", [](const Scene& scene) { return scene.transfer.points; })
        .def_property_readonly("has_own_labels", [](const Scene& scene) { return bool(scene.labels.loaded); })
        .def_property_readonly("has_own_probe", [](const Scene& scene) { return bool(scene.lighting.loaded_probe); });
    module.def("settings", settings);
    module.def("parse_scene", parse);
    module.def("read_scene", read);
}

}  // namespace chiaro::python
