// OpenImageIO 2.4 loses one error text when libpng jumps out of a PNG file that ends too early.
extern "C" const char* __lsan_default_suppressions() { return "leak:ImageInput*geterror\n"; }
