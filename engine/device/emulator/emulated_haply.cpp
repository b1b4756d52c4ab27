#include "engine/device/emulator/emulated_haply.hpp"

#include "engine/device/drivers/haply_line.hpp"
#include "engine/device/drivers/serial_link.hpp"
#include "engine/device/drivers/udp_link.hpp"
#include "engine/device/open/open_line.hpp"

namespace palpate::engine {

std::unique_ptr<BoardDevice> open_haply(const std::string& path,
                                        const Calibration& calibration,
                                        const BoardTiming& timing,
                                        const GuardTiming& guard) {
    return std::make_unique<BoardDevice>(calibration, std::make_unique<SerialLink>(path),
                                         haply_line, std::make_unique<GuardProcess>(guard), timing);
}

std::unique_ptr<BoardDevice> open_board(const std::string& path,
                                        const Calibration& calibration,
                                        const BoardTiming& timing,
                                        const GuardTiming& guard) {
    std::unique_ptr<ByteLink> link;
    if (path.starts_with(kUdp)) {
        link = std::make_unique<UdpLink>(udp_address(path));
    } else {
        link = std::make_unique<SerialLink>(path, true);
    }
    return std::make_unique<BoardDevice>(calibration, std::move(link), open_line,
                                         std::make_unique<GuardProcess>(guard), timing);
}

}  // namespace palpate::engine
