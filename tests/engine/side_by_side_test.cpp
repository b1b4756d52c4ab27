#include "engine/base/side_by_side.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

TEST_CASE("each task is done once before anybody has waited for it, with any number of cores",
          "[side-by-side][law]") {
    SEEDED(random, std::uint64_t{40});
    const auto cores = static_cast<std::size_t>(1 + random.below(4));
    const auto count = static_cast<std::size_t>(1 + random.below(60));
    std::vector<std::atomic<int>> done(count);
    SideBySide work(cores);
    std::size_t next = 0;
    while (next < count) {  // tasks are added while others are worked on and waited for
        for (int more = random.below(9); more >= 0 && next < count; --more) {
            REQUIRE(work.add([&done, next] { ++done[next]; }) == next);
            ++next;
        }
        const auto number = random.index(next);
        work.wait_for(number);
        REQUIRE(done[number] == 1);
    }
    for (std::size_t i = 0; i < count; ++i) {
        work.wait_for(i);
        CHECK(done[i] == 1);
    }
}

TEST_CASE("what a task throws comes to who waits for it, once, and harms no other",
          "[side-by-side][law]") {
    const auto cores = GENERATE(std::size_t{1}, std::size_t{3});
    SideBySide work(cores);
    std::atomic<int> done = 0;
    for (int i = 0; i < 30; ++i) {
        work.add([&done, i] {
            if (i % 3 == 0) {
                throw std::runtime_error("task");
            }
            ++done;
        });
    }
    for (std::size_t i = 0; i < 30; ++i) {
        if (i % 3 == 0) {
            CHECK_THROWS_AS(work.wait_for(i), std::runtime_error);
        }
        CHECK_NOTHROW(work.wait_for(i));
    }
    CHECK(done == 20);
}

TEST_CASE("who ends early waits for what is under way, and for nothing else", "[side-by-side]") {
    std::atomic<int> begun = 0;
    std::atomic<int> ended = 0;
    {
        SideBySide work(2);
        for (int i = 0; i < 1000; ++i) {
            work.add([&] {
                ++begun;
                ++ended;
            });
        }
        work.wait_for(0);
    }
    CHECK(begun == ended);
    CHECK(begun >= 1);
}
