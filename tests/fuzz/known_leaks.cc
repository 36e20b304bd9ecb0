// Read by LeakSanitizer when a fuzzer starts. libfyaml 0.7.12 keeps one buffer (4 KiB, once for each text
// that it refuses) when a quoted text of several lines ends without its closing quote; programs read a
// handful of files.
extern "C" const char* __lsan_default_suppressions();

extern "C" const char* __lsan_default_suppressions() { return "leak:libfyaml.so\n"; }
