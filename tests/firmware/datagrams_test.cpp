#include "engine/device/open/open_line.hpp"
#include "tests/firmware/boards.hpp"
#include "tests/support/board_link.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"

using namespace palpate::engine;

// The driver of `--device board:udp:HOST:PORT` against the firmware, with a network between that
// loses datagrams, doubles them and brings them late. One clock, the board's.

namespace {

/// What a network does to a datagram, as chances.
struct Weather {
    double lost = 0.0;
    double doubled = 0.0;
    double late = 0.0;
    double latest = 0.030;  ///< s
};

/// The way between driver and board.
class Net : public ByteLink {
public:
    Net(OpenBoard& board, Random& random) : board_(&board), random_(&random) {}

    Weather weather{};

    [[nodiscard]] bool send(std::span<const std::uint8_t> packet) noexcept override {
        post(to_board_, packet);
        return true;
    }
    [[nodiscard]] std::ptrdiff_t receive(std::span<std::uint8_t> into,
                                         std::int64_t wait_ns) noexcept override {
        const std::int64_t deadline = now_ + wait_ns;
        while (true) {
            if (const auto one = due(to_host_)) {
                std::copy(one->begin(), one->end(), into.begin());
                return static_cast<std::ptrdiff_t>(one->size());
            }
            if (now_ >= deadline) {
                return 0;
            }
            pause(std::min(kStep, deadline - now_));
        }
    }
    void drain() noexcept override {}
    void pause(std::int64_t ns) noexcept override {
        now_ += ns;
        for (; polled_ + kStep <= now_; polled_ += kStep) {
            while (const auto one = due(to_board_)) {
                board_->post(kHost, *one);
            }
            board_->poll();
            while (const auto letter = board_->letter()) {
                if (letter->to == kHost) {
                    post(to_host_, letter->datagram.view());
                }
            }
        }
    }
    [[nodiscard]] std::int64_t now_ns() const noexcept override { return now_; }
    [[nodiscard]] bool reopen() override { return true; }
    void close() noexcept override {}
    [[nodiscard]] std::string trouble() const override { return {}; }
    [[nodiscard]] std::string name() const override { return "udp:net:1"; }
    [[nodiscard]] bool keeps_packets() const noexcept override { return true; }

private:
    static constexpr std::int64_t kStep = 50'000;
    static constexpr std::uint64_t kHost = 77;
    struct Datagram {
        std::int64_t due = 0;
        std::vector<std::uint8_t> body;
    };

    void post(std::deque<Datagram>& way, std::span<const std::uint8_t> body) {
        const bool lost = random_->in(0.0, 1.0) < weather.lost;
        const int copies = lost ? 0 : random_->in(0.0, 1.0) < weather.doubled ? 2 : 1;
        for (int i = 0; i < copies; ++i) {
            const bool late = random_->in(0.0, 1.0) < weather.late;
            const double takes = 100e-6 + (late ? random_->in(0.0, weather.latest) : 0.0);
            way.push_back(
                {now_ + static_cast<std::int64_t>(takes * 1e9), {body.begin(), body.end()}});
        }
    }
    /// The first that is due, whichever was sent first: late ones are overtaken.
    std::optional<std::vector<std::uint8_t>> due(std::deque<Datagram>& way) {
        const auto one = std::find_if(way.begin(), way.end(),
                                      [&](const Datagram& it) { return it.due <= now_; });
        if (one == way.end()) {
            return std::nullopt;
        }
        std::vector<std::uint8_t> body = std::move(one->body);
        way.erase(one);
        return body;
    }

    OpenBoard* board_;
    Random* random_;
    std::int64_t now_ = 0;
    std::int64_t polled_ = 0;
    std::deque<Datagram> to_board_;
    std::deque<Datagram> to_host_;
};

/// A driver, a network, a board and a hand that is led away from home, 0.15 mm a tick.
struct Wired {
    static constexpr double kStep = 150e-6;

    explicit Wired(std::uint64_t seed) : random(seed) {
        auto link = std::make_unique<Net>(board, random);
        net = link.get();
        device = std::make_unique<BoardDevice>(machine, std::move(link), open_line,
                                               std::make_unique<ScriptedGuard>(guard),
                                               BoardTiming{.still = 0.05});
    }
    Reading tick(const Vec2& force) {
        way += kStep;
        plant.lead(*machine.home - Vec2{0.0, way});
        const Reading reading = device->read();
        device->write(Vec3(force, 0.0));
        next = std::max(next + 1'000'000, net->now_ns());
        net->pause(std::max<std::int64_t>(next - net->now_ns(), 100'000));
        return reading;
    }

    Calibration machine = open_machine();
    Random random;
    GuidedHand plant{machine};
    OpenBoard board = OnHost::make(plant, machine);
    ScriptedGuard::Script guard;
    Net* net = nullptr;
    std::unique_ptr<BoardDevice> device;
    double way = 0.0;  ///< m, of the hand
    std::int64_t next = 0;
};

constexpr Vec2 kPress{0.3, -0.4};

/// What somebody at an address of his own says to a board, and hears.
class Speaker {
public:
    Speaker(OpenBoard& board, std::uint64_t address) : board_(&board), address_(address) {}

    std::optional<OpenAnswer> say(const BoardBytes& body) {
        return post(open_datagram(nonce, body));
    }
    std::optional<OpenAnswer> post(const BoardBytes& datagram) {
        board_->post(address_, datagram.view());
        const auto letter = board_->letter();
        if (!letter) {
            return std::nullopt;
        }
        CHECK(letter->to == address_);
        const auto answer = read_open(letter->datagram.view().subspan(kOpenNonce));
        if (answer && answer->type == OpenType::ident) {
            std::copy_n(letter->datagram.bytes.begin(), kOpenNonce, nonce.begin());
        }
        return answer;
    }
    void arm() {
        REQUIRE(say(open_hello(1))->type == OpenType::ident);
        REQUIRE(say(open_config(2, config))->type == OpenType::configured);
        REQUIRE(say(open_token(OpenType::arm, 3, config.token))->report.state == OpenState::armed);
        static_cast<void>(say(open_torque(4, {50'000, 0})));
    }

    OpenNonce nonce{};
    OpenConfig config{.token = 7, .watchdog_ms = 50, .limit = {100'000, 100'000}};

private:
    OpenBoard* board_;
    std::uint64_t address_;
};

}  // namespace

TEST_CASE("bodies go without frames over a link of datagrams, and its guard knows their answers",
          "[open]") {
    Wired wired(1);
    const std::vector<std::uint8_t> disarm{0, 0, 0, 0, 0, 0, 0, 0, 0x04, 0x00, 0x00, 0xAD, 0xA5};
    class Listening : public Net {
    public:
        using Net::Net;
        [[nodiscard]] bool send(std::span<const std::uint8_t> packet) noexcept override {
            sent.emplace_back(packet.begin(), packet.end());
            return true;
        }
        std::vector<std::vector<std::uint8_t>> sent;
    };
    Listening link(wired.board, wired.random);
    const auto line = open_line(link, wired.machine);
    const GuardPackets packets = line->guard_packets();
    CHECK(std::ranges::equal(packets.zero.view(), disarm));
    CHECK(packets.answer_size == 21);
    CHECK(std::ranges::equal(packets.answer.view(), std::array{0x90, 0x00, 0x00}));
    CHECK(line->probe(1) == BoardLine::Answer::pending);
    CHECK(link.sent.size() == 1);
    CHECK(link.sent.front().size() == 13);
}

TEST_CASE(
    "datagrams that are lost, doubled or late never leave a force on, nor bring an old reading",
    "[open]") {
    int fresh = 0;
    int faults = 0;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        CAPTURE(seed);
        Wired wired(seed);
        for (int i = 0; i < 20; ++i) {
            REQUIRE(wired.tick(kPress).ok());
        }
        wired.net->weather = {.lost = wired.random.in(0.0, 0.9),
                              .doubled = wired.random.in(0.0, 0.5),
                              .late = wired.random.in(0.0, 0.9),
                              .latest = wired.random.in(0.0, 0.05)};
        int faulty = 0;  // ticks since the driver gave up
        for (int i = 0; i < 150; ++i) {
            const Reading reading = wired.tick(kPress);
            faulty += reading.fault == DeviceFault::none ? 0 : 1;
            if (reading.ok() && reading.fresh) {
                ++fresh;
                // It is of the tick before, within a count or two.
                const double behind =
                    wired.way - glm::length(Vec2(reading.hip) - *wired.machine.home);
                CHECK(behind < 2.0 * Wired::kStep + 150e-6);
                CHECK(behind > -150e-6);
            }
            if (faulty > 72) {  // its last torque came 50 ms late at most, and was obeyed for 20
                CHECK(wired.board.torque() == Vec3{});
            }
        }
        faults += faulty > 0 ? 1 : 0;

        // The cable is pulled: the board's own watchdog.
        wired.net->weather = {.lost = 1.0};
        for (int i = 0; i < 22; ++i) {
            static_cast<void>(wired.tick(kPress));
        }
        wired.net->pause(60'000'000);  // what was on its way has come
        CHECK(wired.board.torque() == Vec3{});

        // And it is plugged in again.
        wired.net->weather = {};
        bool back = false;
        for (int i = 0; i < 300 && !back; ++i) {
            wired.net->pause(1'000'000);
            back = wired.device->reconnect();
        }
        CHECK(back);
        wired.device.reset();
        CHECK_FALSE(wired.board.enabled());
    }
    CHECK(fresh > 3000);
    CHECK(faults > 30);
}

TEST_CASE("a datagram is answered by the firmware as the same body in a frame is", "[open]") {
    const Calibration machine = open_machine();
    GuidedHand plant(machine);
    Random random(31);
    const auto facts = [] {
        board_facts known{};
        known.torque_full[0] = known.torque_full[1] = 123'000;
        known.axes = 2;
        return known;
    }();
    OpenBoard by_frame = OnHost::make(plant, machine);
    OpenBoard owner = OnHost::make(plant, machine);  // whose pins a bare board moves
    board bare{};
    board_begin(&bare, &facts, &owner);
    OpenNonce nonce{};
    const OpenConfig config{.token = 7, .limit = {100'000, 100'000}};
    for (std::uint16_t seq = 1; seq < 2000; ++seq) {
        const int kind = seq == 1 ? 0 : random.below(8);
        BoardBytes body = kind == 0 ? open_hello(seq)
                        : kind == 1 ? open_config(seq, config)
                        : kind == 2 ? open_token(OpenType::arm, seq, 7)
                        : kind == 3 ? open_token(OpenType::clear, seq, 7)
                        : kind == 4 ? open_bare(OpenType::disarm, seq)
                        : kind == 5 ? open_bare(OpenType::peek, seq)
                                    : open_torque(seq, {random.below(200'000), -5});
        if (seq > 1 && random.below(5) == 0) {
            body.bytes[random.index(body.size)] ^= 4U;
        }
        const auto was = by_frame.state();
        by_frame.receive(open_frame(body).view());
        by_frame.poll();
        std::array<std::uint8_t, 64> bytes{};
        OpenReader reader;
        std::vector<std::uint8_t> framed;
        for (std::size_t i = 0, size = by_frame.transmit(bytes); i < size; ++i) {
            if (const auto one = reader.take(bytes[i]); !one.empty()) {
                framed.assign(one.begin(), one.end());
            }
        }
        const BoardBytes datagram = open_datagram(nonce, body);
        std::array<std::uint8_t, BOARD_DATAGRAM> answer{};
        std::size_t size = board_datagram(&bare, 9, datagram.bytes.data(),
                                          static_cast<std::uint16_t>(datagram.size), answer.data());
        if (size > 0) {
            std::copy_n(answer.begin(), kOpenNonce, nonce.begin());
            size -= kOpenNonce;
        }
        CAPTURE(seq, kind, was);
        CHECK(size == framed.size());
        CHECK(by_frame.state() == bare.state);
        const auto one = read_open(framed);
        const auto other = read_open({answer.data() + kOpenNonce, size});
        REQUIRE(one.has_value() == other.has_value());
        if (one) {
            CHECK(one->type == other->type);
            CHECK(one->seq == other->seq);
            CHECK(one->report.flags == other->report.flags);
            CHECK(one->why == other->why);
        }
    }
}

TEST_CASE("a stranger's datagrams never become those of the host, nor give a torque", "[open]") {
    const Calibration machine = open_machine();
    GuidedHand plant(machine);
    OpenBoard board = OnHost::make(plant, machine);
    Speaker host(board, 1);
    Speaker stranger(board, 2);
    const auto pass = [&](int ms) {
        for (int i = 0; i < 20 * ms; ++i) {
            board.pass();
        }
    };

    BoardBytes broken = open_datagram({}, open_hello(1));
    broken.bytes[broken.size - 1] ^= 1U;  // begins as a HELLO, and its CRC is wrong
    CHECK_FALSE(stranger.post(broken));
    host.arm();
    REQUIRE(board.torque() != Vec3{});

    SECTION("from another address while the motors are on, or the host is there") {
        for (int i = 0; i < 40; ++i) {
            pass(30);
            const auto said = stranger.say(open_hello(9));
            REQUIRE(said);
            CHECK(said->type == OpenType::nak);
            CHECK(said->why == kOpenOtherHost);
            CHECK(stranger.say(open_torque(static_cast<std::uint16_t>(i), {-90'000, 0}))->why ==
                  kOpenOtherHost);
            CHECK(stranger.say(open_bare(OpenType::disarm, kGuardSeq))->why == kOpenOtherHost);
            CHECK(board.torque() != Vec3{});
            static_cast<void>(
                host.say(open_torque(static_cast<std::uint16_t>(5 + i), {50'000, 0})));
        }
        host.say(open_bare(OpenType::disarm, kGuardSeq));
        for (int i = 0; i < 10; ++i) {
            pass(500);
            CHECK(stranger.say(open_hello(9))->why == kOpenOtherHost);
            host.say(open_bare(OpenType::disarm, kGuardSeq));  // as a guard says it again and again
        }
    }
    SECTION("from the host's own address, spoofed: the nonce is not known") {
        Speaker spoofed(board, 1);
        Random random(3);
        for (int i = 0; i < 2000; ++i) {
            for (std::uint8_t& byte : spoofed.nonce) {
                byte = static_cast<std::uint8_t>(random.below(256));
            }
            spoofed.say(open_torque(static_cast<std::uint16_t>(5 + i % 250), {-90'000, 0}));
            CHECK(board.torque().x > 0.0);
        }
        CHECK(host.say(open_torque(5, {0, 0}))->type == OpenType::state);
        CHECK(board.torque() == Vec3{});
    }
    SECTION("once the host has been silent for a second another one may begin, with a new nonce") {
        pass(990);
        CHECK(stranger.say(open_hello(9))->why == kOpenOtherHost);
        pass(20);
        CHECK(stranger.say(open_hello(10))->type == OpenType::ident);
        CHECK(stranger.nonce != host.nonce);
        CHECK(host.say(open_torque(9, {50'000, 0}))->why == kOpenOtherHost);
        CHECK(board.torque() == Vec3{});
    }
}
