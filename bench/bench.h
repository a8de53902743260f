// `chiaro bench`: choosing the rows, measuring them, and telling what was found.
#pragma once
#include <regex>
#include <span>
#include <string>
#include <vector>

#include "rows.h"

namespace chiaro::bench {

std::span<const Suite> suites();

/// Which rows are wanted; empty: all.
struct Selection {
    std::vector<std::string> suites;
    std::string filter;  ///< regular expression, found anywhere in a row's name
};

/// Measures what is selected and hands each row on as it is found. Throws Error{usage} for an unknown suite or a filter
/// that is no regular expression, Error{interrupted} when cancelled.
void run(const Setup& setup, const Selection& selection, const std::function<void(const Row&)>& found);

std::string heading(const Setup& setup);
std::string line_of(const Row& row);
/// All rows with the machine, the instruction set, the threads and the commit.
std::string to_json(const Setup& setup, const std::vector<Row>& rows);

}  // namespace chiaro::bench
