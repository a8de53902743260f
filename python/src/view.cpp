// The viewer's server, in this process.
#include <chiaro/view.h>

#include "binding.h"

namespace chiaro::python {
namespace {

/// Kept with what it hears by, which is called from a thread of the server's.
class ViewHandle {
public:
    ViewHandle(const Scene& scene, const VolumeHandle* volume, const SourceHandle* source, double memory,
               int finest_level, bool exact, const std::vector<std::string>& folders, const std::string& host, int port,
               const std::string& base_path, const std::vector<std::string>& embed_from, int threads,
               py::object changed)
        : changed_(kept(std::move(changed))) {
        refuse_after_fork();
        ViewSettings settings;
        settings.scene = scene;
        if (volume) settings.volume = volume->volume;
        if (source) settings.source = source->source;
        settings.paging = {std::uint64_t(memory), finest_level, exact};
        for (const std::string& folder : folders) settings.folders.emplace_back(folder);
        settings.host = host, settings.port = port;
        settings.base_path = base_path, settings.embed_from = embed_from;
        settings.device = Device::cpu(threads);
        settings.changed = [changed = changed_](const Scene& newest) { tell(changed, newest); };
        const py::gil_scoped_release unlocked;
        server_.emplace(settings);
    }
    ~ViewHandle() {
        const py::gil_scoped_release unlocked;
        server_.reset();
    }

    int port() const { return server_->port(); }
    std::string url() const { return server_->url(); }
    std::string path_of_one_visit() { return server_->path_of_one_visit(); }
    Scene scene() const { return server_->scene(); }
    void put(const Scene& scene) {
        const py::gil_scoped_release unlocked;
        server_->put(scene);
    }
    void stop() {
        const py::gil_scoped_release unlocked;
        server_->stop();
    }

private:
    static void tell(const std::shared_ptr<const void>& changed, const Scene& newest) {
        if (!Py_IsInitialized()) return;
        const py::gil_scoped_acquire lock;
        auto* const object = static_cast<PyObject*>(const_cast<void*>(changed.get()));
        if (object == Py_None) return;
        try {
            py::reinterpret_borrow<py::object>(object)(newest);
        } catch (py::error_already_set& error) {
            error.discard_as_unraisable("a listener of chiaro.view");
        }
    }

    std::shared_ptr<const void> changed_;
    std::optional<ViewServer> server_;
};

}  // namespace

void add_view(py::module_& module) {
    py::class_<ViewHandle>(module, "ViewServer")
        .def(py::init<const Scene&, const VolumeHandle*, const SourceHandle*, double, int, bool,
                      const std::vector<std::string>&, const std::string&, int, const std::string&,
                      const std::vector<std::string>&, int, py::object>())
        .def_property_readonly("port", &ViewHandle::port)
        .def_property_readonly("url", &ViewHandle::url)
        .def("path_of_one_visit", &ViewHandle::path_of_one_visit)
        .def("scene", &ViewHandle::scene)
        .def("put", &ViewHandle::put)
        .def("stop", &ViewHandle::stop);
}

}  // namespace chiaro::python
