#include "ui/session/rig_parts.hpp"
#include "ui/sound/masked_observer.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/faulty.hpp"

using namespace palpate::protocols;

namespace {

/// Comes in after it was asked a few times, as fast as a test wants it.
class FakePlayer : public ui::NoisePlayer {
public:
    void on() override {
        wanted = true;
        asked_ = asked_ > 0 ? asked_ : 3;
    }
    void off() override {
        wanted = false;
        asked_ = 0;
    }
    [[nodiscard]] bool full() const override {
        asked_ = asked_ > 1 ? asked_ - 1 : asked_;
        return wanted && asked_ == 1 && there;
    }
    [[nodiscard]] double full_s() const override { return played_s; }
    [[nodiscard]] bool works() const override { return there; }
    [[nodiscard]] std::string name() const override { return "fake"; }
    [[nodiscard]] bool audible() const override { return true; }

    bool wanted = false;
    bool there = true;
    double played_s = 0.0;

private:
    mutable int asked_ = 0;
};

/// Keeps the events.
struct Notes : protocols::Recorder {
    void event(const Event& event) override {
        all.push_back(std::string(to_string(event.kind)) + ": " + event.text);
    }
    std::vector<std::string> all;
};

/// A participant who hears whether there is noise when there should be.
class Listener : public Patient {
public:
    explicit Listener(FakePlayer& player) : player_(player) {}
    Signal ready(const TrialView& trial) override {
        silent_while_ready += player_.wanted ? 0 : 1;
        return Patient::ready(trial);
    }
    ExplorationStep explore(const TrialView& trial, double elapsed_s) override {
        silent_under_force += player_.full() ? 0 : 1;
        ++explored;
        return Patient::explore(trial, elapsed_s);
    }
    Choice choose(const TrialView& trial, const Question& question) override {
        noise_elsewhere += player_.wanted ? 1 : 0;
        return Patient::choose(trial, question);
    }
    Signal gap(double seconds) override {
        noise_elsewhere += player_.wanted ? 1 : 0;
        return Patient::gap(seconds);
    }
    std::optional<Signal> trouble(const TroubleView& view) override {
        noise_elsewhere += player_.wanted ? 1 : 0;
        ++troubles;
        return Patient::trouble(view);
    }
    int silent_while_ready = 0, silent_under_force = 0, noise_elsewhere = 0, explored = 0;
    int troubles = 0;

private:
    FakePlayer& player_;
};

void set_driver(const char* name) {
    setenv("SDL_AUDIODRIVER", name, 1);
}

constexpr MaskingSpec kPink{.noise = Noise::pink, .level_db = -30.0};
const StreamKey kKey{.protocol_hash = "h", .participant = "P1", .purpose = {}, .seed = 5};

}  // namespace

TEST_CASE("there is noise whenever the force is on, and none at questions, gaps and in trouble") {
    const Protocol protocol = short_protocol();
    const Plan plan = plan_of(protocol);
    World world{.fault_share = 0.5, .max_faults = 1};
    FaultyApparatus apparatus(world);
    FakePlayer player;
    Listener listener(player);
    Notes notes;
    {
        ui::MaskedObserver masked(listener, player, notes, true);
        const SessionEnd end = run_session(
            protocol, plan, {}, SessionProgress(protocol, plan, {}),
            {.apparatus = apparatus, .observer = masked, .recorder = notes, .pause = [](double) {
             }});
        CHECK(end.why == SessionEnd::Why::finished);
    }
    CHECK(listener.explored > 50);
    CHECK(listener.troubles > 0);
    CHECK(listener.silent_while_ready == 0);
    CHECK(listener.silent_under_force == 0);
    CHECK(listener.noise_elsewhere == 0);
    CHECK_FALSE(player.wanted);
}

TEST_CASE("noise that was not played while an object was felt is an event") {
    FakePlayer player;
    Listener listener(player);
    Notes notes;
    ui::MaskedObserver masked(listener, player, notes, false);
    const TrialView trial{.number = 7, .total = 9};
    const auto feel = [&](double felt_s, double played_s) {
        static_cast<void>(masked.ready(trial));
        std::this_thread::sleep_for(std::chrono::duration<double>(felt_s));
        player.played_s += played_s;
        static_cast<void>(masked.choose(trial, {}));
    };
    feel(0.5, 2.0);  // more than was needed: a device that runs ahead
    CHECK(notes.all.empty());
    feel(0.5, 0.0);
    REQUIRE(notes.all.size() == 1);
    CHECK_THAT(notes.all.front(), Has("masking: 0.5", "trial 7 were without noise"));
    feel(0.01, 0.0);  // less than a device may hold back
    CHECK(notes.all.size() == 1);
}

TEST_CASE("noise goes on between the intervals of a trial, and stops for its question") {
    FakePlayer player;
    Patient patient;
    Notes notes;
    ui::MaskedObserver masked(patient, player, notes, true);
    TrialView trial{.number = 3, .total = 9, .intervals = 2};
    CHECK(masked.ready(trial) == Signal::go_on);
    CHECK(masked.gap(0.0) == Signal::go_on);
    CHECK(player.wanted);
    trial.interval = 2;
    CHECK(masked.ready(trial) == Signal::go_on);
    CHECK(player.full());
    static_cast<void>(masked.choose(trial, {}));
    CHECK_FALSE(player.wanted);
}

TEST_CASE("a lost sound device ends a real session before the next trial, a pilot goes on") {
    const bool required = GENERATE(false, true);
    FakePlayer player;
    Listener listener(player);
    Notes notes;
    ui::MaskedObserver masked(listener, player, notes, required);
    const TrialView trial{.number = 3, .total = 9};
    CHECK(masked.ready(trial) == Signal::go_on);
    static_cast<void>(masked.choose(trial, {}));
    player.there = false;
    if (required) {
        CHECK_THROWS_WITH(masked.ready(trial), Has("was lost: connect it again"));
        CHECK_FALSE(player.wanted);
        CHECK_THAT(notes.all.back(), Has("the sound device was lost"));
    } else {
        CHECK(masked.ready(trial) == Signal::go_on);
    }
}

TEST_CASE(
    "what SDL sends to the device is the noise, the same left and right, beginning in silence") {
    const std::filesystem::path file = std::filesystem::temp_directory_path() /
                                       ("palpate-noise-" + std::to_string(getpid()) + ".raw");
    set_driver("disk");
    setenv("SDL_DISKAUDIOFILE", file.c_str(), 1);
    {
        const auto player = ui::open_noise(kPink, kKey);
        CHECK(player->works());
        CHECK_FALSE(player->audible());
        CHECK_THAT(player->name(),
                   Has("pink noise at -30 dB re full scale, 48000 Hz, driver disk"));
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        player->on();
        while (!player->full()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        while (player->full_s() < 0.3) {
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        player->off();
        std::this_thread::sleep_for(std::chrono::milliseconds(600));
    }
    const std::string bytes = slurp(file);
    std::filesystem::remove(file);
    std::vector<float> samples(bytes.size() / sizeof(float));
    std::memcpy(samples.data(), bytes.data(), samples.size() * sizeof(float));
    REQUIRE(samples.size() > 2 * 48000 / 2);
    CHECK(samples.front() == 0.0F);
    CHECK(samples.back() == 0.0F);
    double loudest = 0.0;
    bool alike = true;
    for (std::size_t i = 0; i + 1 < samples.size(); i += 2) {
        alike = alike && samples[i] == samples[i + 1];
        loudest = std::max(loudest, std::fabs(static_cast<double>(samples[i])));
    }
    CHECK(alike);
    CHECK(loudest > 2.0 * std::pow(10.0, -30.0 / 20.0));
    CHECK(loudest < 6.0 * std::pow(10.0, -30.0 / 20.0));
}

TEST_CASE(
    "a real session that asks for noise is refused where nobody would hear it, a pilot warned") {
    ui::RigSpec spec;
    spec.study.protocol = short_protocol();
    spec.study.protocol.masking = kPink;
    spec.kind = data::RunKind::real;
    spec.device.kind = ui::DeviceChoice::Kind::mouse;  // a person holds it
    set_driver("no_such_driver");
    CHECK_THROWS_WITH(ui::open_masking(spec), Has("masking noise cannot be played", "--no-sound"));
    set_driver("dummy");
    CHECK_THROWS_WITH(ui::open_masking(spec), Has("would reach nobody"));
    spec.kind = data::RunKind::pilot;
    CHECK(ui::open_masking(spec).player);
    set_driver("no_such_driver");
    const ui::OpenedMasking pilot = ui::open_masking(spec);
    CHECK_FALSE(pilot.player);
    CHECK_THAT(pilot.note, Has("none: masking noise cannot be played"));
    spec.kind = data::RunKind::real;
    spec.screen.no_sound = true;
    const ui::OpenedMasking declined = ui::open_masking(spec);
    CHECK_FALSE(declined.player);
    CHECK(declined.note == "none: --no-sound was given");
    spec.screen.no_sound = false;
    spec.device.kind = ui::DeviceChoice::Kind::simulated;
    CHECK(ui::open_masking(spec).note.empty());
    spec.device.kind = ui::DeviceChoice::Kind::mouse;
    spec.study.protocol.masking = {};
    CHECK(ui::open_masking(spec).note.empty());
}
