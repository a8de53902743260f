#include "tool.h"

int main(int argc, char** argv) { return chiaro::cli::run_tool(argc, argv); }
