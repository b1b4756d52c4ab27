#include <sched.h>

#include "engine/base/pcg32.hpp"
#include "engine/base/side_by_side.hpp"
#include "engine/base/text.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

// Expected: test-high/expected/check-pcg32.out of the library pcg-c, seed 42, stream 54, round 1.
// The words are printed, stepped back over and printed again; coins, rolls and cards follow them.
TEST_CASE("PCG32 draws, flips, rolls and deals as pcg-c does") {
    Pcg32 random(42, 54);
    for (const std::uint32_t word :
         {0xa15c02b7U, 0x7b47f409U, 0xba1d3330U, 0x83d2f293U, 0xbfa4784bU, 0xcbed606eU}) {
        CHECK(random.next() == word);
    }

    std::string coins;
    for (int i = 0; i < 65; ++i) {
        coins += random.bounded(2) == 1 ? 'H' : 'T';
    }
    CHECK(coins == "HHTTTHTHHHTHTTTHHHHHTTTHHHTHTHTHTTHTTTHHHHHHTTTTHHTTTTTHTTTTTTTHT");

    std::string rolls;
    for (int i = 0; i < 33; ++i) {
        rolls += std::to_string(random.bounded(6) + 1) + " ";
    }
    CHECK(rolls == "3 4 1 1 2 2 3 2 4 3 2 4 3 3 5 2 3 1 3 1 5 1 4 1 5 6 4 6 6 2 6 3 3 ");

    std::array<std::size_t, 52> deck{};
    std::iota(deck.begin(), deck.end(), std::size_t{0});
    shuffle(std::span<std::size_t>(deck), random);
    std::string cards;
    for (const std::size_t card : deck) {
        cards += std::string("A23456789TJQK").at(card / 4);
        cards += std::string("hcds").at(card % 4);
        cards += ' ';
    }
    CHECK(cards ==
          "Qd Ks 6d 3s 3d 4c 3h Td Kc 5c Jh Kd Jd As 4s 4h Ad Th Ac Jc 7s Qs 2s 7h Kh 2d 6c Ah 4d "
          "Qh 9h 6s 5s 2c 9c Ts 8d 9s 3c 8c Js 5d 2h 6h 7d 8s 9d 5h 8h Qc 7c Tc ");
}

TEST_CASE("a bounded draw is below its bound, and every value comes") {
    Pcg32 random(7, 11);
    for (const std::uint32_t bound : {1U, 2U, 3U, 5U, 6U, 10U, 52U, 100U}) {
        std::vector<int> seen(bound, 0);
        for (std::uint32_t i = 0; i < 200U * bound; ++i) {
            const std::uint32_t drawn = random.bounded(bound);
            REQUIRE(drawn < bound);
            ++seen[drawn];
        }
        // 200 expected of each, standard deviation below 14.2.
        for (const int count : seen) {
            CHECK(count > 200 - 5 * 15);
            CHECK(count < 200 + 5 * 15);
        }
    }
    // 2^32 mod n is largest near 2^31: a third of the words are thrown away.
    for (int i = 0; i < 1000; ++i) {
        CHECK(random.bounded(0x80000001U) <= 0x80000000U);
    }
}

TEST_CASE("a shuffle is a permutation, and nothing and one thing stay as they are") {
    const auto seed = GENERATE(palpate::tests::seeds(std::uint64_t{50}));
    Pcg32 random(seed, 1);
    std::vector<std::size_t> items(static_cast<std::size_t>(seed));
    std::iota(items.begin(), items.end(), std::size_t{0});
    std::vector<std::size_t> shuffled = items;
    shuffle(std::span(shuffled), random);
    CHECK(std::is_permutation(items.begin(), items.end(), shuffled.begin(), shuffled.end()));
}

TEST_CASE("processors are those that a thread may use, not those of the machine") {
    std::vector<std::size_t> found;  // before and after the thread is kept to one
    std::thread([&found] {
        found.push_back(usable_processors());
        cpu_set_t one;
        CPU_ZERO(&one);
        CPU_SET(static_cast<std::size_t>(::sched_getcpu()), &one);
        found.push_back(::sched_setaffinity(0, sizeof one, &one) == 0 ? usable_processors() : 0);
    }).join();
    CHECK(found.front() >= 1);
    CHECK(found.back() == 1);
    CHECK(usable_processors() == found.front());
}

TEST_CASE("each task is done once before anybody has waited for it, with any number of cores") {
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

TEST_CASE("what a task throws comes to who waits for it, once, and harms no other") {
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

TEST_CASE("who ends early waits for what is under way, and for nothing else") {
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

TEST_CASE("one of something has no s, none and several have") {
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
