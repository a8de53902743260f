#include <chiaro/error.h>
#include <chiaro/progress.h>

namespace chiaro {

void Progress::check() const {
    if (cancelled()) throw Error(ErrorCode::interrupted, "interrupted");
}

}  // namespace chiaro
