#include "engine/base/text.hpp"
#include "tests/support/catch.hpp"

TEST_CASE("one of something has no s, none and several have", "[words][law]") {
    CHECK(counted(0, "trial") == "0 trials");
    CHECK(counted(1U, "trial") == "1 trial");
    CHECK(counted(-1, "trial") == "-1 trials");
    for (std::size_t n = 2; n < 1000; n += 7) {
        CHECK(counted(n, "trial") == std::to_string(n) + " trials");
        CHECK(counted(n, "try", "tries") == std::to_string(n) + " tries");
    }
    CHECK(counted(1, "try", "tries") == "1 try");
    CHECK(counted(1, "trial is", "trials are") + " late" == "1 trial is late");
}
