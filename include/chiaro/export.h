// What libchiaro.so shows: everything else in it is hidden.
#pragma once

#define CHIARO_EXPORT __attribute__((visibility("default")))
