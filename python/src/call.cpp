#include <unistd.h>

#include <atomic>
#include <chrono>

#include "binding.h"

namespace chiaro::python {

std::shared_ptr<const void> kept(py::object object) {
    return {object.release().ptr(), [](const void* pointer) {
                if (!Py_IsInitialized()) return;  // the process ends, and its memory with it
                const py::gil_scoped_acquire lock;
                Py_DECREF(static_cast<PyObject*>(const_cast<void*>(pointer)));
            }};
}

void News::report(std::string_view stage, double fraction) {
    if (listeners_.report.is_none()) return;
    const std::lock_guard lock(mutex_);
    stage_.emplace(std::string(stage), fraction);
}

void News::show(const Image& image) {
    const std::lock_guard lock(mutex_);
    image_ = image;
}

void News::tell() {
    std::optional<std::pair<std::string, double>> stage;
    std::optional<Image> image;
    {
        const std::lock_guard lock(mutex_);
        stage.swap(stage_), image.swap(image_);
    }
    if (stage) listeners_.report(stage->first, stage->second);
    if (image) listeners_.preview(array_of(*image));
}

namespace {

std::atomic<pid_t> caller{0};  // the process of the first call

/// Work in a thread, which is waited for whatever happens.
class Worker {
public:
    template <class Work>
    explicit Worker(const Work& work)
        : thread_([this, &work] {
              try {
                  work();
              } catch (...) {
                  failure_ = std::current_exception();
              }
              const std::lock_guard lock(mutex_);
              is_over_ = true;
              over_.notify_one();
          }) {}

    bool wait(std::chrono::milliseconds most) {
        std::unique_lock lock(mutex_);
        return over_.wait_for(lock, most, [&] { return is_over_; });
    }
    std::exception_ptr join() {
        thread_.join();
        return failure_;
    }

private:
    std::mutex mutex_;
    std::condition_variable over_;
    bool is_over_ = false;
    std::exception_ptr failure_;
    std::thread thread_;  // the last member: it uses the others
};

}  // namespace

void refuse_after_fork() {
    const pid_t process = getpid();
    pid_t first = 0;
    if (caller.compare_exchange_strong(first, process) || first == process) return;
    throw Error(ErrorCode::usage,
                "this process was forked from one that had used chiaro, whose threads did not come along: start "
                "processes with multiprocessing.get_context('spawn'), or use chiaro in them alone");
}

void call(Listeners listeners, const std::function<void(Progress&, News&)>& work) {
    refuse_after_fork();
    const auto news = std::make_shared<News>(std::move(listeners));
    Progress progress([&](std::string_view stage, double fraction) { news->report(stage, fraction); });
    std::exception_ptr raised, failure;
    {
        const py::gil_scoped_release unlocked;
        const auto body = [&] { work(progress, *news); };
        Worker worker(body);
        while (!worker.wait(std::chrono::milliseconds(20))) {
            if (raised) continue;
            const py::gil_scoped_acquire lock;
            try {
                if (PyErr_CheckSignals() != 0) throw py::error_already_set();
                news->tell();
            } catch (...) {
                raised = std::current_exception();
                progress.cancel();
            }
        }
        failure = worker.join();
    }
    if (raised) std::rethrow_exception(raised);
    if (failure) std::rethrow_exception(failure);
    news->tell();
}

}  // namespace chiaro::python
