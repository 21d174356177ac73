// OpenImageIO 2.4 leaks one error text when libpng jumps out of a truncated PNG file.
extern "C" const char* __lsan_default_suppressions() { return "leak:ImageInput*geterror\n"; }
