// Pictures, their files and their differences.
#include "binding.h"

namespace chiaro::python {

Array<std::uint8_t> array_of(const Image& image) {
    return {image.pixels, {image.height, image.width, image.has_alpha ? 4 : 3}};
}
Array<float> array_of(const Frame& frame) { return {frame.rgba, {frame.height, frame.width, 4}}; }

Image image_of(py::buffer pixels) {
    const py::buffer_info info = pixels.request();
    Image image;
    image.height = int(info.shape[0]), image.width = int(info.shape[1]), image.has_alpha = info.shape[2] == 4;
    const auto* first = static_cast<const std::uint8_t*>(info.ptr);
    image.pixels.assign(first, first + info.size);
    return image;
}

namespace {

Frame frame_of(py::buffer rgba) {
    const py::buffer_info info = rgba.request();
    Frame frame(int(info.shape[1]), int(info.shape[0]));
    const auto* first = static_cast<const float*>(info.ptr);
    frame.rgba.assign(first, first + info.size);
    return frame;
}

template <class T>
void add_array(py::module_& module, const char* name) {
    py::class_<Array<T>>(module, name, py::buffer_protocol()).def_buffer([](Array<T>& a) {
        std::vector<py::ssize_t> strides(a.shape.size(), sizeof(T));
        for (std::size_t i = a.shape.size() - 1; i-- > 0;) strides[i] = strides[i + 1] * a.shape[i + 1];
        return py::buffer_info(a.values.data(), sizeof(T), py::format_descriptor<T>::format(),
                               py::ssize_t(a.shape.size()), a.shape, strides);
    });
}

py::dict told(const ImageDifference& d) {
    py::dict all;
    all["rmse"] = d.rmse, all["psnr"] = d.psnr, all["ssim"] = d.ssim, all["max"] = d.max, all["bias"] = d.bias;
    return all;
}

py::dict compare_images(py::buffer a, py::buffer b) {
    const Image left = image_of(a), right = image_of(b);
    return told(result_of({}, [&](Progress&, News&) { return compare(display_values(left), display_values(right)); }));
}

py::dict compare_frames(py::buffer a, py::buffer b) {
    const Frame left = frame_of(a), right = frame_of(b);
    return told(result_of({}, [&](Progress&, News&) { return compare(left, right); }));
}

py::dict compare_volumes(const VolumeHandle& a, const VolumeHandle& b) {
    const FieldDifference d = result_of({}, [&](Progress&, News&) { return compare(*a.volume, *b.volume); });
    py::dict all;
    all["rmse"] = d.rmse, all["max"] = d.max, all["bias"] = d.bias, all["correlation"] = d.correlation;
    return all;
}

}  // namespace

void add_images(py::module_& module) {
    add_array<std::uint8_t>(module, "Bytes");
    add_array<float>(module, "Floats");
    add_array<std::uint64_t>(module, "Counts");
    module.def("encode_png", [](py::buffer pixels, const Metadata& metadata) {
        const std::vector<std::byte> png = encode_png(image_of(pixels), metadata);
        return py::bytes(reinterpret_cast<const char*>(png.data()), png.size());
    });
    module.def("write_png", [](py::buffer pixels, const std::string& path, const Metadata& metadata) {
        const Image image = image_of(pixels);
        call({}, [&](Progress& progress, News&) { write_png(image, path, metadata, &progress); });
    });
    module.def("write_exr", [](py::buffer rgba, const std::string& path, const Metadata& metadata) {
        const Frame frame = frame_of(rgba);
        call({}, [&](Progress& progress, News&) { write_exr(frame, path, metadata, &progress); });
    });
    module.def("read_png", [](const std::string& path) { return array_of(read_png(path)); });
    module.def("read_exr", [](const std::string& path) { return array_of(read_exr(path)); });
    module.def("compare_images", compare_images);
    module.def("compare_frames", compare_frames);
    module.def("compare_volumes", compare_volumes);
}

}  // namespace chiaro::python
