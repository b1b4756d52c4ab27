#pragma once

#include "engine/device/drivers/byte_link.hpp"

namespace palpate::engine {

/// A link that is a file descriptor of this machine, non-blocking, on the wall's clock.
class DescriptorLink : public ByteLink {
public:
    [[nodiscard]] std::ptrdiff_t receive(std::span<std::uint8_t> into,
                                         std::int64_t wait_ns) noexcept override;
    void drain() noexcept override;
    void pause(std::int64_t ns) noexcept override;
    [[nodiscard]] std::int64_t now_ns() const noexcept override;
    [[nodiscard]] std::string trouble() const override { return trouble_; }
    [[nodiscard]] int descriptor() const noexcept override { return port_; }

protected:
    /// read(2) gave nothing: is that for good?
    /// @param got  what it returned, 0 or less   @param error  errno then
    [[nodiscard]] virtual bool is_gone(std::ptrdiff_t got, int error) const noexcept = 0;

    std::string trouble_;
    int port_ = -1;
};

}  // namespace palpate::engine
