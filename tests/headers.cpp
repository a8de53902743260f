// Only for what it is compiled with: the headers of all tests.
int main() {}
