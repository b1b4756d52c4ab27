#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The open board: all of its firmware that touches no register. It reads frames, keeps the state, clamps
 * torques and answers. What a chip does is behind the functions named platform_...; palpate's emulator
 * and tests compile the same file for the host.
 *
 * Motors are on in state BOARD_ARMED only. Four ways switch them off, each alone: the host's watchdog and
 * the emergency stop, both in board_tick(); the chip's own watchdog; any reset.
 */

/* Motors that this build can have; how many there are is in board_facts. A chip is built for what hangs on it. */
#ifndef AXES
#ifdef __AVR__
#define AXES 2
#else
#define AXES 3
#endif
#endif

enum {
    BOARD_MAJOR = 1,
    BOARD_MINOR = 0,
    BOARD_FIRMWARE = 1,
    BOARD_BODY = 48,         /* bytes of a frame's body at most */
    BOARD_FRAME = 52,        /* of a whole frame: two zeros, two code bytes */
    BOARD_NONCE = 8,         /* before the body of a datagram */
    BOARD_DATAGRAM = 56,     /* bytes of a datagram at most */
    BOARD_QUIET_HOST = 1000, /* ms without a word of its host, after which another one may say hello */
    BOARD_DUTY = 800,        /* steps of the motors' PWM: 20 kHz at 16 MHz */
    BOARD_WATCHDOG_MIN = 5,  /* ms */
    BOARD_WATCHDOG_MAX = 50
};

enum board_state {
    BOARD_BOOT,        /* nobody said hello since the reset */
    BOARD_IDENTIFIED,  /* it said who it is, and has no limits yet */
    BOARD_CONFIGURED,  /* limits and watchdog are known, motors off */
    BOARD_ARMED,       /* the only state with motors on */
    BOARD_STOPPED      /* it switched them off itself, and waits for a word */
};

/* Bits of the flags in a STATE. */
enum {
    BOARD_STOP_PRESSED = 1 << 0,
    BOARD_WATCHDOG_FIRED = 1 << 1,
    BOARD_CLAMPED_1 = 1 << 2,
    BOARD_CLAMPED_2 = 1 << 3,
    BOARD_STALE = 1 << 4,
    BOARD_SKIPPED_EDGE = 1 << 5,
    BOARD_LOST_BYTES = 1 << 6,
    BOARD_WAS_HUNG = 1 << 7,
    BOARD_ENABLED = 1 << 8,
    BOARD_REFUSED = 1 << 9,
    BOARD_CLAMPED_3 = 1 << 10
};

/* What does not change while it runs. */
struct board_facts {
    uint32_t id;
    int32_t counts_per_turn[AXES];
    int32_t torque_full[AXES]; /* uN m at full duty, > 0 */
    uint8_t axes;              /* 2 or 3, at most AXES */
    uint8_t time_step;         /* us */
    uint8_t reset_cause;       /* bit 0 power, 1 external, 2 brown-out, 3 the chip's watchdog */
};

/* What the platform measures, all at one moment. */
struct board_sense {
    uint32_t time_us;
    int32_t count[AXES];
    bool skipped_edge; /* an encoder went two steps at once since board_facts or the last CONFIG */
    bool lost_bytes;
};

struct board {
    const struct board_facts *facts;
    void *owner; /* the platform's own */

    volatile uint8_t state;   /* enum board_state */
    volatile uint8_t latched; /* BOARD_STOP_PRESSED, BOARD_WATCHDOG_FIRED: also the tick sets them */
    volatile uint8_t age;     /* ms since a torque was obeyed */
    uint8_t watchdog_ms;
    uint16_t once; /* flags that the next STATE reports and clears */
    uint16_t token;
    uint16_t last_seq; /* newest number of a question, and of an ARM or a torque that was obeyed */
    bool asked;           /* a question came since the last DISARM: the host is there */
    int32_t limit[AXES];  /* uN m */
    uint32_t scale[AXES]; /* duty * 2^20 of one uN m */
    uint8_t bad_frames;

    uint8_t body[BOARD_BODY]; /* of the frame that is being read */
    uint8_t size;
    uint8_t left;    /* bytes until the next code byte */
    uint8_t begun;   /* bytes came since the last zero */
    uint8_t spoilt;  /* it cannot be a frame any more */

#ifndef __AVR__      /* who speaks in datagrams: a serial line has one other end */
    uint64_t host;   /* 0: nobody yet */
    uint64_t nonce;  /* of this host */
    uint16_t quiet;  /* ms since its last word */
#endif
};

/* After a reset. The platform has switched the motors off. */
void board_begin(struct board *board, const struct board_facts *facts, void *owner);

/* One byte from the host. Returns how many bytes of `answer` are to be sent, 0 for none. */
uint8_t board_take(struct board *board, uint8_t byte, uint8_t answer[BOARD_FRAME]);

#ifndef __AVR__
/* One datagram of `from`, which is any number but 0 for each address: 8 bytes, then a body without a frame. So is the
 * answer to it, of as many bytes as this returns. The 8 bytes are a secret of the board and its host: HELLO and DISARM
 * need none, every answer brings them, and nothing else is obeyed without. Another host is refused until the first has
 * been silent for BOARD_QUIET_HOST, and while the motors are on. For a device that is a program and not a chip. */
uint8_t board_datagram(struct board *board, uint64_t from, const uint8_t *datagram, uint16_t size,
                       uint8_t answer[BOARD_DATAGRAM]);
/* A number that nobody can guess. */
uint64_t platform_nonce(void);
#endif

/* Every millisecond, from an interrupt. */
void board_tick(struct board *board);

/* What a chip does. All are called with interrupts off, but for platform_lock() itself. */
uint8_t platform_lock(void);
void platform_unlock(uint8_t was);
/* Enable low, then all PWM outputs disconnected and low. */
void platform_motors_off(struct board *board);
/* Enable high; duty is 0. */
void platform_motors_on(struct board *board);
/* From -BOARD_DUTY to BOARD_DUTY. */
void platform_duty(struct board *board, uint8_t motor, int16_t duty);
bool platform_stop_pressed(struct board *board);
void platform_sense(struct board *board, struct board_sense *sense);
/* Forgets skipped edges and lost bytes; counts := 0 if `zero`. */
void platform_forget(struct board *board, bool zero);

#ifdef __cplusplus
}
#endif
