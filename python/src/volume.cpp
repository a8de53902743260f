// Volumes: numpy's memory borrowed, and read files' lent to numpy.
#include <cmath>

#include "binding.h"

namespace chiaro::python {
namespace {

py::tuple tuple_of(const Vec3& v) { return py::make_tuple(v.x, v.y, v.z); }
using Triple = std::tuple<double, double, double>;
Vec3 vector_of(const Triple& v) { return {std::get<0>(v), std::get<1>(v), std::get<2>(v)}; }

World world_of(const std::string& name) {
    return name == "LPS" ? World::lps : name == "RAS" ? World::ras : World::unknown;
}

/// A header and the memory of an array of (z, y, x) in C order, whose type has this name.
VolumeHandle borrow(py::buffer array, const std::string& type, std::tuple<int, int, int> dimensions, int components) {
    auto volume = std::make_shared<Volume>();
    volume->dimensions = {std::get<0>(dimensions), std::get<1>(dimensions), std::get<2>(dimensions)};
    from_text(type, volume->type);
    volume->components = components;
    const std::size_t bytes = volume->voxel_count() * std::size_t(components) * size_of(volume->type);
    const py::buffer_info info = array.request();
    if (std::size_t(info.size) * std::size_t(info.itemsize) != bytes)
        throw Error(ErrorCode::internal, "an array of another size than it says");
    volume->voxels = VoxelBuffer::borrow(info.ptr, bytes, kept(array));
    return {volume};
}

/// The same voxels with another header: nothing is copied.
std::shared_ptr<Volume> with_same_voxels(const VolumeHandle& handle) {
    const Volume& v = *handle.volume;
    auto copy = std::make_shared<Volume>(without_voxels(v));
    copy->voxels = VoxelBuffer::borrow(v.voxels.data(), v.voxels.size(), handle.volume);
    return copy;
}

VolumeHandle placed(const VolumeHandle& handle, Triple spacing, Triple origin, const std::array<Triple, 3>& direction,
                    const std::string& world) {
    auto volume = with_same_voxels(handle);
    volume->geometry.spacing_mm = vector_of(spacing);
    volume->geometry.origin_mm = vector_of(origin);
    for (std::size_t a = 0; a < 3; ++a) volume->geometry.direction[a] = vector_of(direction[a]);
    volume->geometry.world = world_of(world);
    return {volume};
}

VolumeHandle told(const VolumeHandle& handle, const std::string& source, const std::string& format,
                  const std::string& modality, double slope, double intercept) {
    auto volume = with_same_voxels(handle);
    volume->source = source, volume->format = format, volume->modality = modality;
    volume->slope = slope, volume->intercept = intercept;
    return {volume};
}

VolumeHandle at_moment(const VolumeHandle& handle, int shown, int count) {
    auto volume = with_same_voxels(handle);
    volume->moments.shown = shown, volume->moments.count = count;
    return {volume};
}

/// Channels with a name and a colour ("" for none) each, or in colours of their own.
VolumeHandle with_channels(const VolumeHandle& handle, bool own_colors,
                           const std::vector<std::pair<std::string, std::string>>& infos) {
    auto volume = with_same_voxels(handle);
    volume->has_own_colors = own_colors;
    volume->component_infos.clear();
    for (const auto& [name, color] : infos) {
        ComponentInfo& info = volume->component_infos.emplace_back(ComponentInfo{name, {}});
        if (!color.empty()) from_text(color, info.rgb.emplace());
    }
    return {volume};
}

py::list channels_of(const VolumeHandle& handle) {
    py::list all;
    for (const auto& [name, rgb] : handle.volume->component_infos)
        all.append(py::make_tuple(name, rgb ? py::object(py::tuple(py::cast(*rgb))) : py::none()));
    return all;
}

std::string_view format_of(VoxelType type) {
    return with_voxel_type(type, []<class T>(T) { return std::string_view(py::format_descriptor<T>::value, 1); });
}

py::buffer_info lend(VolumeHandle& handle) {
    const Volume& v = *handle.volume;
    std::vector<py::ssize_t> shape{v.dimensions[2], v.dimensions[1], v.dimensions[0]};
    if (v.components > 1) shape.push_back(v.components);
    const auto item = py::ssize_t(size_of(v.type));
    std::vector<py::ssize_t> strides(shape.size(), item);
    for (std::size_t i = shape.size() - 1; i-- > 0;) strides[i] = strides[i + 1] * shape[i + 1];
    return {const_cast<std::byte*>(v.voxels.data()),
            item,
            std::string(format_of(v.type)),
            py::ssize_t(shape.size()),
            shape,
            strides,
            true};
}

std::array<std::tuple<double, double, double>, 3> directions(const Volume& v) {
    std::array<std::tuple<double, double, double>, 3> all;
    for (std::size_t a = 0; a < 3; ++a)
        all[a] = {v.geometry.direction[a].x, v.geometry.direction[a].y, v.geometry.direction[a].z};
    return all;
}

py::dict statistics_of(const VolumeHandle& handle) {
    const Statistics s = result_of({}, [&](Progress& progress, News&) { return measure(*handle.volume, progress); });
    py::dict told;
    told["min"] = s.min, told["max"] = s.max, told["p1"] = s.p1, told["p50"] = s.p50, told["p99"] = s.p99;
    told["p999"] = s.p999, told["noise"] = s.noise, told["nonfinite"] = s.nonfinite;
    told["histogram"] = Array<std::uint64_t>{{s.histogram.begin(), s.histogram.end()}, {256}};
    return told;
}

VolumeHandle read(const std::string& name, const Scene& scene, py::object report) {
    return {result_of({report}, [&](Progress& progress, News&) {
        Scene of_this = scene;
        of_this.volume = name;
        return std::make_shared<const Volume>(read_volume(of_this, progress));
    })};
}

void write(const VolumeHandle& handle, const std::string& path, const std::string& encoding,
           const std::map<std::string, std::string>& key_values, py::object report) {
    auto volume = with_same_voxels(handle);
    for (const auto& [key, value] : key_values) volume->key_values[key] = value;
    NrrdEncoding how{};
    from_text(encoding, how);
    call({report}, [&](Progress& progress, News&) { write_nrrd(*volume, path, how, progress); });
}

}  // namespace

Volume without_voxels(const Volume& v) {
    Volume copy;
    copy.dimensions = v.dimensions, copy.type = v.type, copy.components = v.components;
    copy.has_own_colors = v.has_own_colors, copy.component_infos = v.component_infos;
    copy.slope = v.slope, copy.intercept = v.intercept, copy.geometry = v.geometry;
    copy.source = v.source, copy.format = v.format, copy.modality = v.modality;
    copy.moments = v.moments;
    copy.notes = v.notes, copy.key_values = v.key_values;
    return copy;
}

void add_volume(py::module_& module) {
    using Handle = VolumeHandle;
    py::class_<Handle>(module, "Volume", py::buffer_protocol())
        .def_buffer(lend)
        .def("placed", placed)
        .def("told", told)
        .def("at_moment", at_moment)
        .def("with_channels", with_channels)
        .def_property_readonly("channels", channels_of)
        .def_property_readonly("has_own_colors", [](const Handle& h) { return h.volume->has_own_colors; })
        .def("statistics", statistics_of)
        .def_property_readonly("dimensions",
                               [](const Handle& h) {
                                   return py::make_tuple(h.volume->dimensions[0], h.volume->dimensions[1],
                                                         h.volume->dimensions[2]);
                               })
        .def_property_readonly("type", [](const Handle& h) { return name_of(h.volume->type); })
        .def_property_readonly("components", [](const Handle& h) { return h.volume->components; })
        .def_property_readonly("slope", [](const Handle& h) { return h.volume->slope; })
        .def_property_readonly("intercept", [](const Handle& h) { return h.volume->intercept; })
        .def_property_readonly("spacing", [](const Handle& h) { return tuple_of(h.volume->geometry.spacing_mm); })
        .def_property_readonly("origin", [](const Handle& h) { return tuple_of(h.volume->geometry.origin_mm); })
        .def_property_readonly("direction", [](const Handle& h) { return directions(*h.volume); })
        .def_property_readonly("frame",
                               [](const Handle& h) {
                                   const World world = h.volume->geometry.world;
                                   return world == World::lps ? "LPS" : world == World::ras ? "RAS" : "";
                               })
        .def_property_readonly("source", [](const Handle& h) { return h.volume->source; })
        .def_property_readonly("moments",
                               [](const Handle& h) {
                                   const Moments& m = h.volume->moments;
                                   py::dict told;
                                   told["count"] = m.count, told["shown"] = m.shown;
                                   told["times"] = m.times, told["unit"] = m.unit;
                                   return told;
                               })
        .def_property_readonly("format", [](const Handle& h) { return h.volume->format; })
        .def_property_readonly("modality", [](const Handle& h) { return h.volume->modality; })
        .def_property_readonly("notes", [](const Handle& h) { return h.volume->notes; })
        .def_property_readonly("key_values", [](const Handle& h) { return h.volume->key_values; });
    module.def("borrow", borrow);
    module.def("read", read);
    module.def("write", write);
    module.def("make_sample", [](const std::string& name, int size, py::object report) {
        return Handle{result_of({report}, [&](Progress& progress, News&) {
            return std::make_shared<const Volume>(make_sample(name, size, progress));
        })};
    });
    module.def("list_samples", [] {
        py::list all;
        for (const SampleInfo& s : list_samples()) all.append(py::make_tuple(s.name, s.sentence, s.default_size));
        return all;
    });
}

}  // namespace chiaro::python
