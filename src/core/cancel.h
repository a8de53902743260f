// What waits for another program, deep within a call, ends when the call is cancelled.
#pragma once

namespace chiaro {

/// Throws Error{interrupted} where the call that this thread works for is cancelled: that of a CancelScope, or of the
/// parallel_for that gave it its piece.
void check_cancelled();

}  // namespace chiaro
