// The extension chiaro._chiaro: chiaro's library for the Python in chiaro/, which names and explains what is here.
#include "binding.h"

namespace chiaro::python {
namespace {

/// The class of chiaro/errors.py for each kind of error, with the tool's sentence and exit code.
void translate(std::exception_ptr thrown) {
    if (!thrown) return;
    try {
        std::rethrow_exception(thrown);
    } catch (const Error& error) {
        const py::object make = py::module_::import("chiaro.errors").attr("error_of");
        const py::object raised = make(int(error.code()), std::string(error.what()));
        PyErr_SetObject(py::type::of(raised).ptr(), raised.ptr());
    }
}

}  // namespace
}  // namespace chiaro::python

PYBIND11_MODULE(_chiaro, module) {
    using namespace chiaro::python;
    pybind11::register_exception_translator(translate);
    module.attr("version") = CHIARO_VERSION;
    add_volume(module);
    add_lazy(module);
    add_images(module);
    add_appearance(module);
    add_scene(module);
    add_film(module);
    add_session(module);
    add_view(module);
}
