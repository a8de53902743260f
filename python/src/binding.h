// What the parts of the extension have in common: calls that let other threads of Python run, and values both ways.
#pragma once
#include <chiaro/chiaro.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

namespace chiaro::python {

namespace py = pybind11;

/// A Python object that C++ keeps; let go of by whichever thread is the last.
std::shared_ptr<const void> kept(py::object object);

/// What a call is heard by: report(stage, fraction) and preview(image) are called by the thread that called, in
/// between; what they raise ends the call. None: nobody.
struct Listeners {
    py::object report = py::none(), preview = py::none();
};

/// The news of a call, from the thread that works to the one that called.
class News {
public:
    explicit News(Listeners listeners) : listeners_(std::move(listeners)) {}

    void report(std::string_view stage, double fraction);
    void show(const Image& image);
    bool wants_previews() const { return !listeners_.preview.is_none(); }
    /// With the interpreter's lock. Throws what a listener raised.
    void tell();

private:
    Listeners listeners_;
    std::mutex mutex_;
    std::optional<std::pair<std::string, double>> stage_;
    std::optional<Image> image_;
};

/// Raises where this process was forked after another call: oneTBB's threads did not come along.
void refuse_after_fork();

/// Calls work(progress, news) in a thread of its own, without the interpreter's lock, and looks for signals and news
/// every 20 ms: Ctrl-C cancels the work. Rethrows what the work threw.
void call(Listeners listeners, const std::function<void(Progress&, News&)>& work);

/// The same for work that gives something.
template <class Work>
auto result_of(Listeners listeners, const Work& work) {
    std::optional<decltype(work(std::declval<Progress&>(), std::declval<News&>()))> result;
    call(std::move(listeners), [&](Progress& progress, News& news) { result.emplace(work(progress, news)); });
    return std::move(*result);
}

/// Numbers for numpy, which reads them by the buffer protocol without a copy.
template <class T>
struct Array {
    std::vector<T> values;
    std::vector<py::ssize_t> shape;
};

struct VolumeHandle {
    std::shared_ptr<const Volume> volume;
};

/// A volume that is read by bricks.
struct SourceHandle {
    std::shared_ptr<const BrickSource> source;
};

Volume without_voxels(const Volume& volume);
py::object value_of(const Scene& scene, const std::string& name);
Array<std::uint8_t> array_of(const Image& image);
Array<float> array_of(const Frame& frame);
Image image_of(py::buffer pixels);

void add_volume(py::module_& module);
void add_lazy(py::module_& module);
void add_scene(py::module_& module);
void add_appearance(py::module_& module);
void add_images(py::module_& module);
void add_film(py::module_& module);
void add_session(py::module_& module);
void add_view(py::module_& module);

}  // namespace chiaro::python
