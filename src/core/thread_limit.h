// A limit for what would use every processor.
#pragma once

namespace chiaro {

/// What usable_threads() says from now on; 0: as many as the process may use.
void limit_threads(int count);

}  // namespace chiaro
