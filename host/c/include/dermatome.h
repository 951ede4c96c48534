/*
 * Dermatome: the contacts of a robot's skin in the loop of its controller. docs/c.md shows how to build and link, and a loop.
 *
 * Functions return DERMATOME_OK (0), something above 0 that the function says, or a code below 0 for what went wrong;
 * dermatome_error then says it in words. Units are SI. What is not known is NaN, or 0 where it is whole.
 *
 * Setting up, which may allocate and wait some seconds: dermatome_open, _get_identity, _get_skin, _get_pixels, _tare,
 * _set_drive, _start; and _stop and _close at the end.
 *
 * In the loop, between _start and _stop: dermatome_poll, _wait, _image, _get_counts, _descriptor, _ask_tare, _ask_drive,
 * _answer, and dermatome_place. They allocate nothing and, but for _wait, wait for nothing. (The one exception: a call that
 * finds that a serial port has gone, or takes nothing any more, may allocate some bytes.) dermatome_flag_words and
 * dermatome_error may allocate, and do not wait.
 *
 * The library starts no threads, but one or two for a bus that boards share. A board is used by one thread at a time,
 * whichever; boards are independent of each other.
 *
 * Memory: records and buffers are the caller's, and their sizes in bytes go along (sizeof), which tells a header that does
 * not fit the library. Pointers are null where that is allowed, else lead to as much as the size says. Text that goes in ends
 * with a NUL, as does text that comes out, which is cut off where there is no room. A board is one that dermatome_open gave and
 * that is not closed.
 *
 * Made of the library's sources; do not edit.
 */

#ifndef DERMATOME_H
#define DERMATOME_H

#include <stddef.h>
#include <stdint.h>

// Done. For `dermatome_poll` and `dermatome_wait`: no frame has come yet.
#define DERMATOME_OK 0

// A frame was written.
#define DERMATOME_FRAME 1

// The answer to what was asked has not come yet.
#define DERMATOME_PENDING 2

// A null pointer, or a number out of range.
#define DERMATOME_ARGUMENT -1

// A record or a buffer is not as long as it must be: header and library are not of one version, or there is too little room.
#define DERMATOME_SIZE -2

// Not now: it needs a stream, or that there is none.
#define DERMATOME_STATE -3

// The port does not exist, is no port, or cannot be opened.
#define DERMATOME_PORT -4

// This user may not open the port.
#define DERMATOME_PERMISSION -5

// Another program holds the port, or the board serves another host.
#define DERMATOME_IN_USE -6

// Nothing came back, or nothing that is readable: no board, another baud rate, a bad cable.
#define DERMATOME_NO_ANSWER -7

// The board has gone or closed the link, or the cable was pulled. Close the handle and open the port anew.
#define DERMATOME_CUT -8

// Board and library speak different versions of the protocol: update the older one.
#define DERMATOME_VERSION -9

// The board did not do it, and says why.
#define DERMATOME_REFUSED -10

// The board holds no patch: it does not know its skin.
#define DERMATOME_NO_PATCH -11

// The board holds another patch than the one asked for.
#define DERMATOME_WRONG_PATCH -12

// No frame has come for as long as `silence_ms` says, also while a board makes its reference for longer than that (of 20
// frames at the start, or of those that were asked for): poll on, as stopping ends that reference. A board that has started
// anew behind a serial adapter sends none until it is told to: stop and start, or close the handle and open the port anew.
#define DERMATOME_SILENT -13

// A fault of this library. The handle can only be closed.
#define DERMATOME_FAULT -14

// A sample reached the end of the converter's range.
#define DERMATOME_SATURATED 1

// An electrode has no contact.
#define DERMATOME_OPEN_ELECTRODE 2

// An electrode is connected to its neighbour.
#define DERMATOME_SHORTED_ELECTRODE 4

// No current flows.
#define DERMATOME_NO_CURRENT 8

// Voltages with drive and sense exchanged differ.
#define DERMATOME_NOT_RECIPROCAL 16

// Voltages differ from the reference by more than any press could explain.
#define DERMATOME_IMPLAUSIBLE 32

// The board lost samples between the frame before and this one; alone it leaves a frame valid.
#define DERMATOME_MISSED 64

// Measurements with bad electrodes count for nothing.
#define DERMATOME_MASKED 128

// The board's chip is hotter than it may be.
#define DERMATOME_HOT 256

// Voltages have changed unlike a press: a stretched skin, a moved electrode.
#define DERMATOME_UNLIKE_PRESS 512

// What pressed when the reference was made has been lifted.
#define DERMATOME_LIFTED 1024

// An electrode touches worse than when the reference was made.
#define DERMATOME_WORSE_CONTACT 2048

// Most contacts of a frame.
#define DERMATOME_MAX_CONTACTS 8

// Most pixels of an image.
#define DERMATOME_MAX_PIXELS 1024

// Bytes of a name, its NUL included.
#define DERMATOME_NAME_BYTES 40

// The part of a voltage in phase with the current goes into the image.
#define DERMATOME_REAL 0

// The part in quadrature.
#define DERMATOME_IMAGINARY 1

// The length of the phasor.
#define DERMATOME_MAGNITUDE 2

// A board that is open.
typedef struct dermatome_board dermatome_board;

// Who a board is.
typedef struct dermatome_identity {
  // Kind of board, such as "nucleo-g474re" or "simulated".
  char board[DERMATOME_NAME_BYTES];
  // Version of its firmware.
  char firmware[DERMATOME_NAME_BYTES];
} dermatome_identity;

// How a skin is driven and measured.
typedef struct dermatome_drive {
  // Carrier frequency, Hz.
  float frequency;
  // Current amplitude, A.
  float amplitude;
  // Frames a second, at most.
  float frame_rate;
  // By how much the in-phase reference lags the current, degrees, 0 to 360.
  float phase;
  // Carrier periods between switching and measuring, 0 to 100.
  float settling;
  // Carrier periods over which a voltage is measured, 1 to 64.
  uint8_t integration;
  // Gain of the amplifier: 1, 2, 4, 8, 16, 32 or 64; 0 where the board finds it.
  uint8_t gain;
  // Which part of a voltage goes into the image: DERMATOME_REAL, _IMAGINARY or _MAGNITUDE.
  uint8_t component;
  // 0.
  uint8_t reserved;
} dermatome_drive;

// The skin that a board knows, by its patch.
typedef struct dermatome_skin {
  // Name.
  char name[DERMATOME_NAME_BYTES];
  // Checksum of the patch, which identifies it: the last four bytes of its file, the lowest first.
  uint32_t patch_crc;
  // Electrodes.
  uint16_t electrodes;
  // Steps in a frame.
  uint16_t steps;
  // Pixels of the image.
  uint16_t pixels;
  // 1 where there is a reference, so that contacts can be found; else 0.
  uint8_t has_reference;
  // 0.
  uint8_t reserved[5];
  // How it is driven.
  struct dermatome_drive drive;
} dermatome_skin;

// A pixel of a skin's image, in the skin's frame.
typedef struct dermatome_pixel {
  // Centre, m.
  float centre[3];
  // Unit normal.
  float normal[3];
  // Area, m^2.
  float area;
} dermatome_pixel;

// What is streamed.
typedef struct dermatome_options {
  // Contacts of every so many frames; 0 for none.
  uint16_t contacts_every;
  // Images of every so many frames; 0 for none.
  uint16_t images_every;
  // Checksum of the patch that the board must hold; 0 for any.
  uint32_t patch_crc;
  // After so long without a frame polling says DERMATOME_SILENT, ms; 0 for five frames, and at least a second.
  uint32_t silence_ms;
} dermatome_options;

// What has come since the stream began, and what has not. Nothing is lost that is not counted here.
typedef struct dermatome_counts {
  // Frames that came, complete or not.
  uint64_t frames;
  // Frames that were due and of which nothing came: lost, or not made, as while the board makes its reference.
  uint64_t frames_missing;
  // Contacts and images that are missing in frames that came.
  uint64_t parts_missing;
  // Contacts and images that came too late to be used.
  uint64_t parts_unused;
  // Messages that the board sent and that did not come, since the port was opened.
  uint64_t events_lost;
  // Packets that were not readable, since the port was opened.
  uint64_t packets_damaged;
  // References that the board made.
  uint64_t tares;
  // Of so many frames one has an image; 0: none. On a bus with other boards that may be more than was asked for.
  uint64_t images_every;
} dermatome_counts;

// One place where the skin is pressed.
typedef struct dermatome_contact {
  // Its number, the same from frame to frame; 0 where it has none yet.
  uint32_t id;
  // Number of the contact that became one with it, as long as they are one; 0 for none.
  uint32_t merged;
  // Number of the contact that it came out of; 0 for none.
  uint32_t split_from;
  // Centre of pressure, m.
  float position[3];
  // Unit normal of the skin there, outward: what presses pushes against it.
  float normal[3];
  // Velocity, m/s.
  float velocity[3];
  // Area, m^2.
  float area;
  // Mean relative conductivity change.
  float strength;
  // Greatest relative conductivity change.
  float peak;
  // Pressure, Pa; NaN on a skin that is not calibrated.
  float pressure;
  // Force along the normal, N; NaN on a skin whose calibration does not tell it.
  float force;
  // Area that bears the load, m^2; NaN likewise.
  float load_area;
  // By how many standard deviations it is above the noise; NaN where contacts are found in the image.
  float significance;
  // Standard deviation of the position along the skin, m; NaN likewise.
  float position_deviation;
  // Standard deviation of the strength; NaN likewise.
  float strength_deviation;
} dermatome_contact;

// One scan of the skin.
typedef struct dermatome_frame {
  // When the scan ended, us of the board's own clock.
  uint64_t time_us;
  // Running number of the scan since the board started.
  uint32_t sequence;
  // What was wrong with the scan: DERMATOME_SATURATED and the like.
  uint16_t flags;
  // 1 where nothing is known to be wrong with the contacts; else 0.
  uint8_t valid;
  // 1 where contacts came with the frame, be they none; else 0.
  uint8_t has_contacts;
  // 1 where an image came, which `dermatome_image` gives; else 0.
  uint8_t has_image;
  // 0.
  uint8_t reserved[3];
  // How many contacts there are.
  uint32_t contact_count;
  // What has come so far.
  struct dermatome_counts counts;
  // Contacts, strongest first, in the skin's frame; beyond the count all zero.
  struct dermatome_contact contacts[DERMATOME_MAX_CONTACTS];
} dermatome_frame;

// Where a skin lies on a link of a robot: points of its frame are turned, then moved into the link's. As `[pose]` in its skin
// file.
typedef struct dermatome_pose {
  // The skin's origin in the link's frame, m.
  double position[3];
  // Turn from the skin's frame to the link's, a unit quaternion x, y, z, w.
  double orientation[4];
} dermatome_pose;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Version of the library, such as "0.1.0".
const char *dermatome_version(void);

// The name of a code in few words.
const char *dermatome_code_name(int code);

// What the flags of a frame say, in words with commas between them, at most `size` bytes with the NUL.
int dermatome_flag_words(uint16_t flags, char *words, size_t size);

// Opens the port of a board, `/dev/ttyACM0`, `tcp:HOST:PORT`, `rs485:LINE#ADDRESS` or `can:BUS#ADDRESS`, and makes sure that
// board and library understand each other: some seconds at most. Where it fails, `*board` is null and `words` (of `size`
// bytes; may be null) says why.
int dermatome_open(const char *port,
                   struct dermatome_board **board,
                   char *words,
                   size_t size);

// Closes a board, and ends its stream. Null is no board, and nothing is done.
void dermatome_close(struct dermatome_board *board);

// Why the last call with this board that failed did, in words.
int dermatome_error(const struct dermatome_board *board, char *words, size_t size);

// Who the board is.
int dermatome_get_identity(struct dermatome_board *board, struct dermatome_identity *identity, size_t size);

// The skin that the board knows by its patch; before `dermatome_start`. DERMATOME_NO_PATCH where it knows none.
int dermatome_get_skin(struct dermatome_board *board,
                       struct dermatome_skin *skin,
                       size_t size);

// Where the pixels of its images lie: `[pixel]`, in `size` bytes; before `dermatome_start`. Gives how many there are.
int dermatome_get_pixels(struct dermatome_board *board,
                         struct dermatome_pixel *pixels,
                         size_t size);

// Makes a new reference of `frames` frames of the untouched skin (20 are usual), and waits for it; before
// `dermatome_start`. A board without a reference makes one by itself when it starts to stream.
int dermatome_tare(struct dermatome_board *board, uint16_t frames);

// Drives the skin like this from now on; null: as its patch says. Before `dermatome_start`.
int dermatome_set_drive(struct dermatome_board *board, const struct dermatome_drive *drive, size_t size);

// Has the board stream; null: the contacts of each frame. All memory that the loop needs is there afterwards.
int dermatome_start(struct dermatome_board *board, const struct dermatome_options *options, size_t size);

// The next frame that is there, without waiting: DERMATOME_FRAME where it was written, DERMATOME_OK where none has come. Call it
// until it does not say DERMATOME_FRAME any more.
int dermatome_poll(struct dermatome_board *board,
                   struct dermatome_frame *frame,
                   size_t size);

// The same, waiting for a frame `timeout_us` microseconds at most.
int dermatome_wait(struct dermatome_board *board,
                   struct dermatome_frame *frame,
                   size_t size,
                   uint32_t timeout_us);

// The image of the last frame: relative conductivity change, `[pixel]`, in `size` bytes. Gives how many pixels there are.
int dermatome_image(struct dermatome_board *board,
                    float *values,
                    size_t size);

// What has come since `dermatome_start`, and what has not; each frame has it too.
int dermatome_get_counts(struct dermatome_board *board, struct dermatome_counts *counts, size_t size);

// The file descriptor of the port, for poll(2), select(2) and epoll(7): once it is readable, call `dermatome_poll`. It is the
// library's: neither read nor close it. Call `dermatome_poll` each few seconds also where it is not readable. A board on a
// bus with others has none.
int dermatome_descriptor(struct dermatome_board *board);

// Asks for a new reference of `frames` frames of the untouched skin, without waiting. `dermatome_answer` says whether the board
// does it; `counts.tares` grows when it has. Meanwhile there are no contacts, and polling may say DERMATOME_SILENT.
int dermatome_ask_tare(struct dermatome_board *board,
                       uint16_t frames);

// Asks for another drive, without waiting; null: as the patch says. The board needs a new reference then.
int dermatome_ask_drive(struct dermatome_board *board, const struct dermatome_drive *drive, size_t size);

// What became of the last request: DERMATOME_OK where the board does it or nothing was asked, DERMATOME_PENDING until its answer
// has come in by `dermatome_poll`; else what went wrong. One request waits at a time.
int dermatome_answer(struct dermatome_board *board);

// Ends the stream, and waits for the board to have done so. It may be started again.
int dermatome_stop(struct dermatome_board *board);

// A contact of the skin's frame in the frame of the link that the skin lies on with this pose. `placed` may be `contact`.
int dermatome_place(const struct dermatome_pose *pose,
                    const struct dermatome_contact *contact,
                    struct dermatome_contact *placed,
                    size_t size);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* DERMATOME_H */
