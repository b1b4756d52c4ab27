#include "engine/device/pointer_device.hpp"
#include "ui/doctor/checks.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::ui;

namespace {

/// Answers with a fault after some readings.
class Failing : public engine::Device {
public:
    explicit Failing(int good) : good_(good) {}
    engine::Reading read() noexcept override {
        return {.fault = good_-- > 0 ? engine::DeviceFault::none : engine::DeviceFault::silent};
    }
    engine::AppliedForce write(const engine::Vec3& force) noexcept override {
        worst_ += force == engine::Vec3{} ? 0 : 1;
        return {};
    }
    std::string name() const override { return "failing"; }
    std::string trouble() const override { return "no answer: plug it in again"; }
    std::optional<double> weakest_force(const engine::Vec3& /*hip*/) const noexcept override {
        return 2.5;
    }

    static inline int worst_ = 0;  ///< writes of another force than zero

private:
    int good_;
};

Check named(const std::string& name, CheckStatus status) {
    Check check;
    check.name = name;
    check.status = status;
    return check;
}

}  // namespace

TEST_CASE("a check that throws is a failed check with what was thrown") {
    const Check check = guarded("disk", []() -> Check { throw std::runtime_error("no room"); });
    CHECK(check.name == "disk");
    CHECK(check.status == CheckStatus::fail);
    CHECK(check.detail == "no room");
    CHECK(any_fails({named("a", CheckStatus::ok), check}));
    CHECK_FALSE(any_fails({named("a", CheckStatus::ok), named("b", CheckStatus::warn)}));
}

TEST_CASE("a device is looked at with zero force, and its own words are the remedy") {
    const auto look = [](int good) {
        return check_device("x", [&] { return std::make_unique<Failing>(good); }, {});
    };
    const Check bad = look(17);
    CHECK(bad.status == CheckStatus::fail);
    CHECK_THAT(bad.detail, Has("17 of 200"));
    CHECK(bad.remedy == "no answer: plug it in again");
    const Check good = look(1000);
    CHECK(good.status == CheckStatus::ok);
    CHECK_THAT(good.detail, Has("at least 2.5 N at the start"));
    CHECK(Failing::worst_ == 0);

    const Check absent =
        check_device("haply:X",
                     []() -> std::unique_ptr<engine::Device> {
                         throw std::runtime_error("there is no /dev/x: plug the board in");
                     },
                     {});
    CHECK(absent.status == CheckStatus::fail);
    CHECK(absent.remedy == "there is no /dev/x: plug the board in");
    const Check pointer =
        check_device("mouse", [] { return std::make_unique<engine::PointerDevice>(); }, {});
    CHECK(pointer.status == CheckStatus::ok);
    CHECK_THAT(pointer.detail, Has("gives no force"));
}

TEST_CASE("the kinematics check passes a linkage and fails one whose workspace it cannot reach") {
    const Linkage good{.name = "good", .centre = {0.0125, 0.05}};
    CHECK(check_kinematics({&good, 1}).status == CheckStatus::ok);
    const Linkage away{.name = "away", .centre = {2.0, 0.05}};
    const Check bad = check_kinematics({&away, 1});
    CHECK(bad.status == CheckStatus::fail);
    CHECK_FALSE(bad.remedy.empty());
}

TEST_CASE("cyclictest's histogram is read: counts, overflows, quantiles by hand") {
    const auto result = parse_cyclictest(
        "# /dev/cpu_dma_latency set to 0us\n# Histogram\n"
        "000000 000000\n000001 000040\n000002 000050\n000003 000008\n000004 000000\n"
        "# Total: 000000098\n# Min Latencies: 00001\n# Avg Latencies: 00002\n"
        "# Max Latencies: 00412\n# Histogram Overflows: 00002\n"
        "# Histogram Overflow at cycle number:\n# Thread 0: 00071 00120\n\n");
    REQUIRE(result.has_value());
    CHECK(result->total() == 100);
    CHECK(result->max_us == 412.0);
    CHECK(result->quantile_us(0.40) == Approx(2.0));  // the 40 cycles of bin 1 fill it
    CHECK(result->quantile_us(0.50) == Approx(2.2));  // 10 of the 50 in bin 2
    CHECK(result->quantile_us(0.98) == Approx(4.0));
    CHECK(result->quantile_us(0.99) == 412.0);
    for (const char* other : {"", "sh: cyclictest: not found", "# Total: 000000000\n",
                              "000001 000000\n", "12 nonsense\nmore of it"}) {
        CAPTURE(other);
        CHECK_FALSE(parse_cyclictest(other).has_value());
    }
}

TEST_CASE("the bars of a lateness histogram count every tick once") {
    engine::LatenessHistogram histogram;
    for (const std::int64_t us : {0, 3, 12, 12, 15, 40, 700, 20'000}) {
        histogram.add(us * 1'000, us > 500);
    }
    long long sum = 0;
    const std::vector<std::string> lines = bars(histogram);
    for (const std::string& line : lines) {
        CAPTURE(line);
        sum += std::stoll(line.substr(9));
    }
    CHECK(sum == 8);
    CHECK(lines.front().starts_with("<    1 us"));
    CHECK(lines.back().starts_with(">=  10 ms"));
    CHECK(bars(engine::LatenessHistogram{}).size() <= 1);
}

TEST_CASE("jitter is judged by the share of late ticks") {
    const auto judged = [](int ticks, int late) {
        JitterRun run;
        run.rate_hz = 1000.0;
        for (int i = 0; i < ticks; ++i) {
            run.all.lateness.add(i < late ? 600'000 : 20'000, i < late);
        }
        return check_jitter(run);
    };
    CHECK(judged(10'000, 0).status == CheckStatus::ok);
    CHECK(judged(10'000, 2).status == CheckStatus::ok);
    CHECK(judged(10'000, 20).status == CheckStatus::warn);
    CHECK(judged(10'000, 200).status == CheckStatus::fail);
    CHECK_FALSE(judged(10'000, 200).remedy.empty());
    CHECK(judged(0, 0).status == CheckStatus::fail);
}

TEST_CASE("a disk that is not there or not ours fails with a remedy, a folder that is passes") {
    CHECK(check_disk("/no/such/folder/study.sqlite").status == CheckStatus::fail);
    CHECK_FALSE(check_disk("/no/such/folder/study.sqlite").remedy.empty());
    const Check here = check_disk("study.sqlite");
    CHECK(here.status != CheckStatus::fail);
    CHECK(here.numbers.size() == 3);
}

TEST_CASE("a font that is asked for and not there fails with a remedy") {
    const Check check = check_font("/no/such/font.ttf");
    CHECK(check.status == CheckStatus::fail);
    CHECK_THAT(check.remedy, Has("/no/such/font.ttf"));
}

TEST_CASE("a line says status, name and detail, and the remedy behind an arrow") {
    Check check = named("disk", CheckStatus::warn);
    check.detail = "slow";
    check.remedy = "use another one";
    CHECK(as_text(check) ==
          "warn  disk                 slow\n                           -> use another one\n");
    check.detail = std::string(70, 'a') + ' ' + std::string(70, 'b');
    CHECK_THAT(as_text(check), Has("a\n                           b"));
    CHECK(verdict({check, named("x", CheckStatus::ok)}) == "1 ok, 1 to look at, 0 failed\n");
}

TEST_CASE("JSON stays valid with quotes, line ends, broken UTF-8 and numbers that are none") {
    Check check = named("a\"b\\c\nd\x01", CheckStatus::ok);
    check.detail = "caf\xc3\xa9 \xff \xc3( \xe2\x82\xac \xed\xa0\x80 \xc3";
    check.numbers = {{"nan", std::numeric_limits<double>::quiet_NaN()},
                     {"inf", std::numeric_limits<double>::infinity()},
                     {"half", 0.5}};
    const std::string text = as_json("1.0", {check});
    const auto says = [&text](const std::string& words) {
        return text.find(words) != std::string::npos;
    };
    CHECK(says(R"("name": "a\"b\\c\nd\u0001")"));
    const std::string lost =
        "\xef\xbf\xbd";  // U+FFFD, one for every byte that is none of a character
    CHECK(says("\"caf\xc3\xa9 " + lost + ' ' + lost + "( \xe2\x82\xac " + lost + lost + lost + ' ' +
               lost + '"'));
    CHECK((says(R"("nan": null)") && says(R"("inf": null)") && says(R"("half": 0.5)")));
    CHECK(as_json("1.0", {}) == "{\n  \"palpate\": \"1.0\",\n  \"checks\": []\n}\n");
}
