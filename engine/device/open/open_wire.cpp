#include "engine/device/open/open_wire.hpp"

#include <algorithm>

namespace palpate::engine {
namespace {

constexpr std::uint16_t kPolynomial = 0x8408;  // 0x1021, reflected
constexpr std::size_t kHead = 3;
constexpr std::size_t kCrc = 2;
constexpr std::size_t kNakSize = 2;

/// Bytes of a payload without its numbers by axis, and how many of these each axis has.
struct Shape {
    std::size_t bytes = 0;
    std::size_t numbers = 1;
};
constexpr Shape kIdent{.bytes = 13, .numbers = 2};
constexpr Shape kConfig{.bytes = 4};
constexpr Shape kReport{.bytes = 8};

/// How many axes a payload of this length speaks of; 0: it has another shape.
constexpr std::size_t axes_of(const Shape& shape, std::size_t payload) noexcept {
    for (std::size_t axes = 2; axes <= kMaxAxes; ++axes) {
        if (payload == shape.bytes + 4 * shape.numbers * axes) {
            return axes;
        }
    }
    return 0;
}

class Writer {
public:
    Writer(OpenType type, std::uint16_t seq) noexcept {
        u8(static_cast<std::uint8_t>(type));
        u16(seq);
    }
    void u8(std::uint8_t value) noexcept { out_.add(value); }
    void u16(std::uint16_t value) noexcept {
        u8(static_cast<std::uint8_t>(value));
        u8(static_cast<std::uint8_t>(value >> 8U));
    }
    void i32(const OpenAxes& values, std::size_t axes) noexcept {
        for (std::size_t i = 0; i < axes; ++i) {
            i32(values[i]);
        }
    }
    void i32(std::int32_t value) noexcept {
        const auto bits = static_cast<std::uint32_t>(value);
        u16(static_cast<std::uint16_t>(bits));
        u16(static_cast<std::uint16_t>(bits >> 16U));
    }
    [[nodiscard]] BoardBytes done() noexcept {
        u16(open_crc(out_.view()));
        return out_;
    }

private:
    BoardBytes out_;
};

class Cursor {
public:
    explicit Cursor(std::span<const std::uint8_t> bytes) noexcept : bytes_(bytes) {}
    [[nodiscard]] std::uint8_t u8() noexcept { return bytes_[at_++]; }
    [[nodiscard]] std::uint16_t u16() noexcept {
        const std::uint8_t low = u8();
        return static_cast<std::uint16_t>(low | u8() << 8U);
    }
    [[nodiscard]] std::uint32_t u32() noexcept {
        const std::uint32_t low = u16();
        return low | std::uint32_t{u16()} << 16U;
    }
    [[nodiscard]] OpenAxes i32(std::size_t axes) noexcept {
        OpenAxes values{};
        for (std::size_t i = 0; i < axes; ++i) {
            values[i] = static_cast<std::int32_t>(u32());
        }
        return values;
    }

private:
    std::span<const std::uint8_t> bytes_;
    std::size_t at_ = 0;
};

OpenIdent read_ident(Cursor& in, std::size_t axes) noexcept {
    OpenIdent ident;
    ident.axes = axes;
    ident.major = in.u8();
    ident.minor = in.u8();
    ident.firmware = in.u16();
    ident.id = in.u32();
    ident.counts_per_turn = in.i32(axes);
    ident.torque_full = in.i32(axes);
    ident.watchdog_min = in.u8();
    ident.watchdog_max = in.u8();
    ident.reset_cause = in.u8();
    ident.time_step = in.u8();
    ident.state = static_cast<OpenState>(in.u8());
    return ident;
}

OpenConfig read_config(Cursor& in, std::size_t axes) noexcept {
    OpenConfig config;
    config.axes = axes;
    config.token = in.u16();
    config.watchdog_ms = in.u8();
    config.zero_counts = in.u8() == 1;
    config.limit = in.i32(axes);
    return config;
}

OpenReport read_report(Cursor& in, std::size_t axes) noexcept {
    OpenReport report;
    report.axes = axes;
    report.state = static_cast<OpenState>(in.u8());
    report.flags = in.u16();
    report.time_us = in.u32();
    report.counts = in.i32(axes);
    report.bad_frames = in.u8();
    return report;
}

}  // namespace

std::uint16_t open_crc(std::span<const std::uint8_t> bytes) noexcept {
    std::uint32_t crc = 0xFFFF;
    for (const std::uint8_t byte : bytes) {
        crc ^= byte;
        for (int bit = 0; bit < 8; ++bit) {
            crc = (crc & 1U) != 0 ? crc >> 1U ^ kPolynomial : crc >> 1U;
        }
    }
    return static_cast<std::uint16_t>(crc ^ 0xFFFFU);
}

BoardBytes open_hello(std::uint16_t seq) noexcept {
    Writer out(OpenType::hello, seq);
    out.u8(kOpenMajor);
    out.u8(0);
    return out.done();
}

BoardBytes open_config(std::uint16_t seq, const OpenConfig& config) noexcept {
    Writer out(OpenType::config, seq);
    out.u16(config.token);
    out.u8(config.watchdog_ms);
    out.u8(static_cast<std::uint8_t>(config.zero_counts ? 1 : 0));
    out.i32(config.limit, config.axes);
    return out.done();
}

BoardBytes open_token(OpenType type, std::uint16_t seq, std::uint16_t token) noexcept {
    Writer out(type, seq);
    out.u16(token);
    return out.done();
}

BoardBytes open_bare(OpenType type, std::uint16_t seq) noexcept {
    return Writer(type, seq).done();
}

BoardBytes open_torque(std::uint16_t seq, const OpenAxes& torque, std::size_t axes) noexcept {
    Writer out(OpenType::torque, seq);
    out.i32(torque, axes);
    return out.done();
}

BoardBytes open_datagram(const OpenNonce& nonce, const BoardBytes& body) noexcept {
    BoardBytes datagram;
    datagram.size = kOpenNonce + body.size;
    const auto rest = std::copy(nonce.begin(), nonce.end(), datagram.bytes.begin());
    std::copy_n(body.bytes.begin(), body.size, rest);
    return datagram;
}

/// Bodies are shorter than a block of COBS: no block is full.
BoardBytes open_frame(const BoardBytes& body) noexcept {
    BoardBytes frame;
    std::size_t code = 1;
    frame.size = 2;
    for (const std::uint8_t byte : body.view()) {
        if (byte != 0) {
            frame.add(byte);
            continue;
        }
        frame.bytes[code] = static_cast<std::uint8_t>(frame.size - code);
        code = frame.size++;
    }
    frame.bytes[code] = static_cast<std::uint8_t>(frame.size - code);
    frame.add(0);
    return frame;
}

std::optional<OpenAnswer> read_open(std::span<const std::uint8_t> body) noexcept {
    if (body.size() < kHead + kCrc || body.size() > kOpenBody) {
        return std::nullopt;
    }
    const std::size_t payload = body.size() - kHead - kCrc;
    const std::uint16_t crc = open_crc(body.first(body.size() - kCrc));
    if (body[body.size() - 2] != (crc & 0xFFU) || body[body.size() - 1] != crc >> 8U) {
        return std::nullopt;
    }
    Cursor in(body);
    OpenAnswer answer;
    answer.type = static_cast<OpenType>(in.u8());
    answer.seq = in.u16();
    const std::size_t axes = axes_of(answer.type == OpenType::ident        ? kIdent
                                     : answer.type == OpenType::configured ? kConfig
                                                                           : kReport,
                                     payload);
    if (answer.type == OpenType::ident && axes > 0) {
        answer.ident = read_ident(in, axes);
    } else if (answer.type == OpenType::configured && axes > 0) {
        answer.config = read_config(in, axes);
    } else if (answer.type == OpenType::state && axes > 0) {
        answer.report = read_report(in, axes);
    } else if (answer.type == OpenType::nak && payload == kNakSize) {
        static_cast<void>(in.u8());
        answer.why = in.u8();
    } else {
        return std::nullopt;
    }
    return answer;
}

std::span<const std::uint8_t> OpenReader::take(std::uint8_t byte) noexcept {
    if (byte == 0) {
        const bool whole = begun_ && !spoilt_ && left_ == 0;
        const std::size_t size = whole ? size_ : 0;
        size_ = 0;
        left_ = 0;
        begun_ = spoilt_ = false;
        return {body_.data(), size};
    }
    const bool code = left_ == 0;
    if (!code || begun_) {  // a code byte stands for the zero before it
        if (size_ == body_.size()) {
            spoilt_ = true;
        } else {
            body_[size_++] = code ? std::uint8_t{0} : byte;
        }
    }
    left_ = static_cast<std::uint8_t>((code ? byte : left_) - 1);
    begun_ = true;
    return {};
}

}  // namespace palpate::engine
