#include "tests/fuzz/entries.hpp"

// One of the entries as libFuzzer calls it: PALPATE_FUZZ_ENTRY is its name.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    palpate::fuzz::PALPATE_FUZZ_ENTRY({data, size});
    return 0;
}
