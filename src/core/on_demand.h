// What is made when it is first asked for.
#pragma once
#include <functional>
#include <mutex>
#include <optional>

namespace chiaro {

/// By whichever thread asks first; the others wait.
template <class T>
class OnDemand {
public:
    explicit OnDemand(std::function<T()> make) : make_(std::move(make)) {}

    const T& get() const {
        std::call_once(once_, [&] { made_.emplace(make_()); });
        return *made_;
    }

private:
    const std::function<T()> make_;
    mutable std::once_flag once_;
    mutable std::optional<T> made_;
};

}  // namespace chiaro
