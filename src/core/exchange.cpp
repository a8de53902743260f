#include <chiaro/exchange.h>

namespace chiaro {

Exchange::~Exchange() = default;

}  // namespace chiaro
