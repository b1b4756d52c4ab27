#include "engine/device/firmware/board.h"

#include <string.h>

enum {
    HELLO = 0x01,
    CONFIG = 0x02,
    ARM = 0x03,
    DISARM = 0x04,
    CLEAR = 0x05,
    TORQUE = 0x10,
    PEEK = 0x11,
    IDENT = 0x81,
    CONFIGURED = 0x82,
    STATE = 0x90,
    NAK = 0xFF
};

enum { WHY_VERSION = 1, WHY_STATE, WHY_VALUE, WHY_STOP_PRESSED, WHY_TOKEN, WHY_TYPE, WHY_OTHER_HOST, WHY_NONCE };

enum { HEAD = 3, CRC = 2, MAX_STEP = 255, MAX_AHEAD = 32767 };

/* A chip has what it was built for. */
#ifdef __AVR__
#define AXES_OF(board) ((void)(board), (uint8_t)AXES)
#else
#define AXES_OF(board) ((board)->facts->axes)
#endif

static const uint16_t kGood = 0xF0B8; /* of a body with its own CRC */

/* A body that is being written. */
struct writer {
    uint8_t bytes[BOARD_BODY];
    uint8_t size;
};

/* CRC-16/X-25, reflected 0x1021, of each byte. */
static uint16_t crc_table[256];

static void fill_crc_table(void)
{
    for (uint16_t byte = 0; byte < 256; ++byte) {
        uint16_t crc = byte;
        for (uint8_t bit = 0; bit < 8; ++bit) {
            crc = (uint16_t)((crc & 1) != 0 ? crc >> 1 ^ 0x8408 : crc >> 1);
        }
        crc_table[byte] = crc;
    }
}

static uint16_t crc_of(const uint8_t *bytes, uint8_t size)
{
    uint16_t crc = 0xFFFF;
    for (uint8_t i = 0; i < size; ++i) {
        crc = (uint16_t)(crc >> 8 ^ crc_table[(uint8_t)(bytes[i] ^ (uint8_t)crc)]);
    }
    return crc;
}

static uint16_t get16(const uint8_t *at)
{
    return (uint16_t)(at[0] | (uint16_t)at[1] << 8);
}

static int32_t get32(const uint8_t *at)
{
    return (int32_t)(get16(at) | (uint32_t)get16(at + 2) << 16);
}

/* Numbers that were heard before, or that are further on than `max`, are late or lost. */
static bool newer(const struct board *board, uint16_t max)
{
    const uint16_t step = (uint16_t)(get16(board->body + 1) - board->last_seq);
    return step != 0 && step <= max;
}

static void put8(struct writer *out, uint8_t value)
{
    out->bytes[out->size++] = value;
}

static void put16(struct writer *out, uint16_t value)
{
    put8(out, (uint8_t)value);
    put8(out, (uint8_t)(value >> 8));
}

static void put32(struct writer *out, uint32_t value)
{
    put16(out, (uint16_t)value);
    put16(out, (uint16_t)(value >> 16));
}

/* A number for each axis. */
static void put_axes(struct writer *out, const struct board *board, const int32_t *numbers)
{
    for (uint8_t i = 0; i < AXES_OF(board); ++i) {
        put32(out, (uint32_t)numbers[i]);
    }
}

/* A body begins with the type of the answer and the number of its question. */
static void begin(struct writer *out, uint8_t type, const struct board *board)
{
    out->size = 0;
    put8(out, type);
    put8(out, board->body[1]);
    put8(out, board->body[2]);
}

/* Zero, COBS of body and CRC, zero. Bodies are short: no block is full. */
static uint8_t framed(struct writer *body, uint8_t *frame)
{
    uint8_t code = 1;
    uint8_t at = 2;
    put16(body, (uint16_t)~crc_of(body->bytes, body->size));
    frame[0] = 0;
    for (uint8_t i = 0; i < body->size; ++i) {
        if (body->bytes[i] != 0) {
            frame[at++] = body->bytes[i];
            continue;
        }
        frame[code] = (uint8_t)(at - code);
        code = at++;
    }
    frame[code] = (uint8_t)(at - code);
    frame[at++] = 0;
    return at;
}

static uint8_t refused(const struct board *board, uint8_t why, uint8_t *answer)
{
    struct writer out;
    begin(&out, NAK, board);
    put8(&out, board->body[0]);
    put8(&out, why);
    return framed(&out, answer);
}

static uint8_t tell_state(struct board *board, const struct board_sense *sense, uint8_t *answer)
{
    struct writer out;
    uint16_t flags = (uint16_t)(board->once | board->latched);
    flags |= sense->skipped_edge ? BOARD_SKIPPED_EDGE : 0;
    flags |= sense->lost_bytes ? BOARD_LOST_BYTES : 0;
    flags |= (board->facts->reset_cause & 8) != 0 ? BOARD_WAS_HUNG : 0;
    const uint8_t state = board->state;
    flags |= state == BOARD_ARMED ? BOARD_ENABLED : 0;
    begin(&out, STATE, board);
    put8(&out, state);
    put16(&out, flags);
    put32(&out, sense->time_us);
    put_axes(&out, board, sense->count);
    put8(&out, board->bad_frames);
    board->once = 0;
    return framed(&out, answer);
}

/* Motors off and, if they were on, the state that comes then. With interrupts off. */
static void stop(struct board *board, uint8_t next)
{
    platform_motors_off(board);
    if (board->state == BOARD_ARMED) {
        board->state = next;
    }
}

void board_begin(struct board *board, const struct board_facts *facts, void *owner)
{
    static const struct board kFresh;
    fill_crc_table();
    *board = kFresh;
    board->facts = facts;
    board->owner = owner;
    for (uint8_t i = 0; i < AXES_OF(board); ++i) {
        board->scale[i] = ((uint32_t)BOARD_DUTY << 20) / (uint32_t)facts->torque_full[i];
    }
}

void board_tick(struct board *board)
{
#ifndef __AVR__
    if (board->quiet < BOARD_QUIET_HOST) {
        ++board->quiet;
    }
#endif
    if (platform_stop_pressed(board)) {
        board->latched |= BOARD_STOP_PRESSED;
        stop(board, BOARD_STOPPED);
    }
    if (board->state == BOARD_ARMED && ++board->age >= board->watchdog_ms) {
        board->latched |= BOARD_WATCHDOG_FIRED;
        stop(board, BOARD_STOPPED);
    }
}

static uint8_t hello(struct board *board, uint8_t *answer)
{
    const struct board_facts *facts = board->facts;
    struct writer out;
    if (board->body[HEAD] != BOARD_MAJOR) {
        return refused(board, WHY_VERSION, answer);
    }
    if (board->state == BOARD_BOOT) {
        board->state = BOARD_IDENTIFIED;
    }
    begin(&out, IDENT, board);
    put8(&out, BOARD_MAJOR);
    put8(&out, BOARD_MINOR);
    put16(&out, BOARD_FIRMWARE);
    put32(&out, facts->id);
    put_axes(&out, board, facts->counts_per_turn);
    put_axes(&out, board, facts->torque_full);
    put8(&out, BOARD_WATCHDOG_MIN);
    put8(&out, BOARD_WATCHDOG_MAX);
    put8(&out, facts->reset_cause);
    put8(&out, facts->time_step);
    put8(&out, board->state);
    return framed(&out, answer);
}

/* Takes back what stopped the board; the switch's flag only once it is released. */
static void forgive(struct board *board, uint8_t next)
{
    const uint8_t lock = platform_lock();
    stop(board, next);
    board->state = next;
    board->latched = platform_stop_pressed(board) ? BOARD_STOP_PRESSED : 0;
    platform_unlock(lock);
}

static uint8_t config(struct board *board, uint8_t *answer)
{
    const uint8_t *payload = board->body + HEAD;
    const uint8_t watchdog = payload[2];
    const uint8_t options = payload[3];
    struct writer out;
    if (board->state == BOARD_BOOT || board->state == BOARD_ARMED) {
        return refused(board, WHY_STATE, answer);
    }
    if (get16(payload) == 0 || watchdog < BOARD_WATCHDOG_MIN || watchdog > BOARD_WATCHDOG_MAX ||
        (options & ~1) != 0) {
        return refused(board, WHY_VALUE, answer);
    }
    for (uint8_t i = 0; i < AXES_OF(board); ++i) {
        const int32_t limit = get32(payload + 4 + 4 * i);
        if (limit < 0 || limit > board->facts->torque_full[i]) {
            return refused(board, WHY_VALUE, answer);
        }
    }
    board->token = get16(payload);
    board->watchdog_ms = watchdog;
    for (uint8_t i = 0; i < AXES_OF(board); ++i) {
        board->limit[i] = get32(payload + 4 + 4 * i);
    }
    const uint8_t lock = platform_lock();
    platform_forget(board, (options & 1) != 0);
    platform_unlock(lock);
    forgive(board, BOARD_CONFIGURED);
    board->once = 0;
    board->last_seq = get16(board->body + 1);
    board->asked = true;
    begin(&out, CONFIGURED, board);
    put16(&out, board->token);
    put8(&out, board->watchdog_ms);
    put8(&out, options);
    put_axes(&out, board, board->limit);
    return framed(&out, answer);
}

/* Why the host may not do this now; 0: it may. */
static uint8_t objection(struct board *board, bool fits)
{
    if (!fits) {
        return WHY_STATE;
    }
    if (get16(board->body + HEAD) != board->token) {
        return WHY_TOKEN;
    }
    return platform_stop_pressed(board) ? WHY_STOP_PRESSED : 0;
}

/* An ARM that comes late finds a DISARM after which nobody asked, or a newer question. */
static uint8_t arm(struct board *board)
{
    const uint8_t lock = platform_lock();
    const bool due = board->asked && newer(board, MAX_STEP);
    const uint8_t why = objection(board, board->state == BOARD_CONFIGURED && due);
    if (why == 0) {
        board->last_seq = get16(board->body + 1);
        board->age = 0;
        board->state = BOARD_ARMED;
        platform_motors_on(board);
    }
    platform_unlock(lock);
    return why;
}

static uint8_t clear(struct board *board)
{
    const uint8_t lock = platform_lock();
    const uint8_t why =
        objection(board, board->state == BOARD_CONFIGURED || board->state == BOARD_STOPPED);
    if (why == 0) {
        forgive(board, BOARD_CONFIGURED);
    }
    platform_unlock(lock);
    return why;
}

/* Clamped before the sign is taken: the least number has no positive. */
static int16_t duty_of(struct board *board, uint8_t motor, int32_t torque)
{
    const int32_t limit = board->limit[motor];
    if (torque > limit || torque < -limit) {
        board->once |= (uint16_t)(motor == 2 ? BOARD_CLAMPED_3 : BOARD_CLAMPED_1 << motor);
        torque = torque > 0 ? limit : -limit;
    }
    const uint32_t size = (uint32_t)(torque < 0 ? -torque : torque);
    const int16_t duty = (int16_t)((size * board->scale[motor]) >> 20);
    return torque < 0 ? (int16_t)-duty : duty;
}

static void torque(struct board *board)
{
    if (board->state != BOARD_ARMED) {
        board->once |= BOARD_REFUSED;
        return;
    }
    if (!newer(board, MAX_STEP)) {
        board->once |= BOARD_STALE;
        return;
    }
    int16_t duty[AXES];
    for (uint8_t i = 0; i < AXES_OF(board); ++i) {
        duty[i] = duty_of(board, i, get32(board->body + HEAD + 4 * i));
    }
    const uint8_t lock = platform_lock();
    if (board->state == BOARD_ARMED) { /* the tick may have stopped the motors meanwhile */
        board->last_seq = get16(board->body + 1);
        board->age = 0;
        for (uint8_t i = 0; i < AXES_OF(board); ++i) {
            platform_duty(board, i, duty[i]);
        }
    }
    platform_unlock(lock);
}

/* Length of the payload of a type, or -1. */
static int8_t payload_of(const struct board *board, uint8_t type)
{
    const int8_t numbers = (int8_t)(4 * AXES_OF(board));
    switch (type) {
        case HELLO:
        case ARM:
        case CLEAR:
            return 2;
        case CONFIG:
            return (int8_t)(4 + numbers);
        case TORQUE:
            return numbers;
        case DISARM:
        case PEEK:
            return 0;
        default:
            return -1;
    }
}

static uint8_t obey(struct board *board, uint8_t *answer)
{
    struct board_sense sense;
    uint8_t why = 0;
    uint8_t lock = platform_lock();
    platform_sense(board, &sense);
    platform_unlock(lock);
    if (payload_of(board, board->body[0]) != (int8_t)(board->size - HEAD - CRC)) {
        return refused(board, WHY_TYPE, answer);
    }
    if ((board->body[0] == PEEK || board->body[0] == CLEAR) && newer(board, MAX_AHEAD)) {
        board->last_seq = get16(board->body + 1);
        board->asked = true;
    }
    switch (board->body[0]) {
        case HELLO:
            return hello(board, answer);
        case CONFIG:
            return config(board, answer);
        case ARM:
            why = arm(board);
            break;
        case DISARM:
            lock = platform_lock();
            stop(board, BOARD_CONFIGURED);
            platform_unlock(lock);
            board->asked = false;
            break;
        case CLEAR:
            why = clear(board);
            break;
        case TORQUE:
            torque(board);
            break;
        default:
            break;
    }
    return why != 0 ? refused(board, why, answer) : tell_state(board, &sense, answer);
}

static void keep(struct board *board, uint8_t byte)
{
    if (board->size == BOARD_BODY) {
        board->spoilt = 1;
        return;
    }
    board->body[board->size++] = byte;
}

static uint8_t end_of_frame(struct board *board, uint8_t *answer)
{
    const bool whole = board->spoilt == 0 && board->left == 0 && board->size >= HEAD + CRC &&
                       crc_of(board->body, board->size) == kGood;
    if (whole) {
        return obey(board, answer);
    }
    ++board->bad_frames;
    return 0;
}

uint8_t board_take(struct board *board, uint8_t byte, uint8_t answer[BOARD_FRAME])
{
    uint8_t size = 0;
    if (byte != 0) {
        if (board->left > 0) {
            --board->left;
            keep(board, byte);
        } else {
            if (board->begun != 0) {
                keep(board, 0);
            }
            board->begun = 1;
            board->left = (uint8_t)(byte - 1);
        }
        return 0;
    }
    if (board->begun != 0) {
        size = end_of_frame(board, answer);
    }
    board->size = 0;
    board->left = 0;
    board->begun = 0;
    board->spoilt = 0;
    return size;
}

#ifndef __AVR__
/* Whether `from` may speak, and why not; 0: it may. The body is whole. */
static uint8_t stranger(struct board *board, uint64_t from, const uint8_t *nonce)
{
    const bool hello = board->body[0] == HELLO && board->size == HEAD + 2 + CRC;
    if (from != board->host) {
        if (!hello || board->state == BOARD_ARMED ||
            (board->host != 0 && board->quiet < BOARD_QUIET_HOST)) {
            return WHY_OTHER_HOST;
        }
        board->host = from;
        board->nonce = platform_nonce();
    }
    if (!hello && board->body[0] != DISARM && memcmp(nonce, &board->nonce, BOARD_NONCE) != 0) {
        return WHY_NONCE;
    }
    board->quiet = 0;
    return 0;
}

uint8_t board_datagram(struct board *board, uint64_t from, const uint8_t *datagram, uint16_t size,
                       uint8_t answer[BOARD_DATAGRAM])
{
    uint8_t frame[BOARD_FRAME];
    uint8_t end = 0;
    uint8_t count = BOARD_NONCE;
    if (size < BOARD_NONCE + HEAD + CRC || size > BOARD_DATAGRAM ||
        crc_of(datagram + BOARD_NONCE, (uint8_t)(size - BOARD_NONCE)) != kGood) {
        ++board->bad_frames;
        return 0;
    }
    board->size = (uint8_t)(size - BOARD_NONCE);
    memcpy(board->body, datagram + BOARD_NONCE, board->size);
    const uint8_t why = stranger(board, from, datagram);
    end = why != 0 ? refused(board, why, frame) : obey(board, frame);
    board->size = 0;
    memset(answer, 0, BOARD_NONCE);
    if (why == 0) {
        memcpy(answer, &board->nonce, BOARD_NONCE);
    }
    for (uint8_t at = 1; at + 1 < end;) { /* out of its frame again */
        const uint8_t next = (uint8_t)(at + frame[at]);
        while (++at < next) {
            answer[count++] = frame[at];
        }
        if (at + 1 < end) {
            answer[count++] = 0;
        }
    }
    return count;
}
#endif
