// Sessions: one volume, and what was made of it.
#include <chiaro/session.h>

#include "binding.h"

namespace chiaro::python {
namespace {

/// The device that the tool would take, by the same names.
Device device_of(const std::string& name, int threads, const std::string& isa) {
    Device host = Device::cpu(threads);
    if (!isa.empty()) {
        Isa wanted{};
        from_text(isa, wanted);
        host = Device::cpu(threads, wanted);
    }
    if (name == "cpu") return host;
    if (name == "auto") return choose_device(host).device;
    if (name == "cuda") return Device::cuda(0, host);
    if (name.rfind("cuda:", 0) == 0 && name.size() < 9 && name.find_first_not_of("0123456789", 5) == name.npos &&
        name.size() > 5)
        return Device::cuda(std::stoi(name.substr(5)), host);
    throw Error(ErrorCode::usage, "device='" + name + "': must be auto, cpu or cuda:N");
}

/// A session, which one call at a time uses.
class SessionHandle {
public:
    SessionHandle(const std::string& device, int threads, const std::string& isa)
        : device_(device_of(device, threads, isa)), session_(device_) {}

    void show(const VolumeHandle& volume, py::object report) {
        use({report}, [&](Progress& progress, News&) { session_.show(*volume.volume, progress); });
    }
    /// Whole where it fits in so many bytes (0: in half of what is free), else by bricks.
    void show_source(const SourceHandle& handle, double memory, int finest_level, bool exact, py::object report) {
        use({report}, [&](Progress& progress, News&) {
            const PagingSettings paging{std::uint64_t(memory), finest_level, exact};
            if (fits(*handle.source, paging))
                session_.show(read_level(*handle.source, 0, progress), progress);
            else
                session_.show(handle.source, paging, progress);
        });
    }
    /// As the tool's --stats has it; None: the volume is there as a whole.
    py::object paging() const {
        const auto found = session_.paging();
        if (!found) return py::none();
        py::dict told;
        told["level"] = found->level, told["levels"] = found->levels;
        told["dimensions"] = found->dimensions, told["stopped_by"] = found->stopped_by;
        told["light_level"] = found->light_level, told["bricks"] = found->bricks;
        told["bricks_read"] = found->bricks_read, told["faults"] = found->faults;
        return told;
    }
    /// A later moment: what its values mean, and what the scene's camera fits, is the first one's.
    Scene show_moment(Scene scene, const VolumeHandle& first, const VolumeHandle& volume, py::object report) {
        use({report}, [&](Progress& progress, News&) {
            session_.show(*first.volume, progress);
            scene.camera = session_.fit(scene, progress);
            session_.show_moment(*volume.volume, progress);
        });
        return scene;
    }
    void expect_one_look() { session_.expect_one_look(); }

    Array<std::uint8_t> render(const Scene& scene, py::object report, py::object preview) {
        Image image;
        use({report, preview}, [&](Progress& progress, News& news) {
            const Preview show = [&](const Image& better) { news.show(better); };
            image = session_.render(scene, progress, news.wants_previews() ? show : Preview());
        });
        return array_of(image);
    }
    Array<std::uint8_t> preview(const Scene& scene) {
        Image image;
        use({}, [&](Progress& progress, News&) { image = session_.preview(scene, progress); });
        return array_of(image);
    }
    Array<float> frame(const Scene& scene) {
        Frame frame;
        use({}, [&](Progress& progress, News&) { frame = expose(session_.frame(), scene.output, &progress); });
        return array_of(frame);
    }
    /// The scene of the last render, with what it found: the ball that the camera fits, and the exposure.
    Scene seen(const Scene& scene) const { return session_.as_seen(scene); }
    /// With the ball that all frames of a turntable fit.
    Scene fitted_all_around(Scene scene, py::object report) {
        use({report}, [&](Progress& progress, News&) { scene.camera = session_.fit_all_around(scene, progress); });
        return scene;
    }
    Array<float> depth() {
        Array<float> depth;
        use({}, [&](Progress& progress, News&) {
            const Frame& frame = session_.frame_with_depth(progress);
            depth = {frame.depth_mm, {frame.height, frame.width}};
        });
        return depth;
    }
    py::tuple field(const Scene& scene, py::object report) {
        std::optional<ComputedField> field;
        use({report}, [&](Progress& progress, News&) { field = session_.compute_field(scene, progress); });
        return py::make_tuple(VolumeHandle{std::make_shared<const Volume>(std::move(field->volume))}, stages());
    }
    std::vector<std::pair<std::string, double>> stages() const {
        std::vector<std::pair<std::string, double>> all;
        for (const Stage& stage : session_.stages()) all.emplace_back(stage.name, stage.seconds);
        return all;
    }
    py::dict render_statistics() const {
        const RenderStatistics s = session_.render_statistics();
        py::dict told;
        told["samples"] = s.samples, told["paths"] = s.paths.samples, told["noise"] = s.paths.noise;
        told["relative_noise"] = s.paths.relative_noise;
        return told;
    }
    py::tuple guess() const {
        const Guess& g = session_.guess();
        return py::make_tuple(g.modality, g.preset, g.reason);
    }
    py::dict device() const {
        py::dict told;
        told["device"] = device_.name(), told["isa"] = name_of(device_.isa), told["threads"] = device_.threads;
        return told;
    }
    std::vector<std::string> notes() const { return session_.notes(); }
    TransferFunction transfer(const Scene& scene) const { return session_.resolve(scene.transfer); }

    py::list compare(const Scene& scene, const std::vector<std::string>& names, py::object report) {
        std::vector<Method> methods(names.size());
        for (std::size_t i = 0; i < names.size(); ++i) from_text(names[i], methods[i]);
        std::optional<MethodComparison> made;
        use({report}, [&](Progress& progress, News&) { made = compare_methods(session_, scene, methods, progress); });
        py::list all;
        for (const MethodImage& image : made->images) {
            py::dict told;
            told["method"] = to_text(image.method), told["linear"] = array_of(image.frame);
            told["reference"] = array_of(made->references[image.reference].image.frame);
            told["light"] = made->references[image.reference].light;
            told["rmse"] = image.distance.rmse, told["psnr"] = image.distance.psnr, told["ssim"] = image.distance.ssim;
            told["block_error"] = image.block_error, told["light_seconds"] = image.light_seconds;
            told["frame_seconds"] = image.frame_seconds;
            all.append(told);
        }
        return all;
    }

private:
    void use(Listeners listeners, const std::function<void(Progress&, News&)>& work) {
        call(std::move(listeners), [&](Progress& progress, News& news) {
            const std::lock_guard lock(mutex_);
            work(progress, news);
        });
    }

    std::mutex mutex_;
    Device device_;
    Session session_;
};

}  // namespace

void add_session(py::module_& module) {
    using S = SessionHandle;
    py::class_<S>(module, "Session")
        .def(py::init<const std::string&, int, const std::string&>())
        .def("show_moment", &SessionHandle::show_moment)
        .def("show", &S::show)
        .def("show_source", &S::show_source)
        .def("paging", &S::paging)
        .def("expect_one_look", &S::expect_one_look)
        .def("render", &S::render)
        .def("preview", &S::preview)
        .def("frame", &S::frame)
        .def("depth", &S::depth)
        .def("seen", &S::seen)
        .def("fitted_all_around", &S::fitted_all_around)
        .def("field", &S::field)
        .def("stages", &S::stages)
        .def("render_statistics", &S::render_statistics)
        .def("guess", &S::guess)
        .def("device", &S::device)
        .def("notes", &S::notes)
        .def("transfer", &S::transfer)
        .def("compare", &S::compare);
    module.def("list_methods", [] {
        py::list all;
        for (const MethodInfo& m : list_methods()) all.append(py::make_tuple(m.name, m.sentence));
        return all;
    });
    module.def("list_formats", [] {
        py::list all;
        for (const FormatInfo& f : list_formats()) all.append(py::make_tuple(f.name, f.extensions, f.note));
        return all;
    });
}

}  // namespace chiaro::python
