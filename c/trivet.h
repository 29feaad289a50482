/**
 * @file
 * Recognize the models of a library in scans, from any language that can call C.
 *
 * Open a library, give it points or a depth image, read what was found, free it:
 *
 * @code{.c}
 * trivet_library* library = NULL;
 * trivet_result* result = NULL;
 * trivet_error error;
 * if (trivet_open("parts.h5", NULL, &library, &error) != TRIVET_OK) return fail(error.message);
 * if (trivet_recognize_points(library, xyz, TRIVET_FLOAT32, num_points, 1, 3, NULL,
 *                             TRIVET_UNIT_OF_LIBRARY, NULL, NULL, &result, &error) == TRIVET_OK) {
 *   trivet_detection detection;
 *   for (size_t i = 0; trivet_get_detection(result, i, &detection) == TRIVET_OK; ++i)
 *     printf("%s %g\n", trivet_model_name(library, detection.model), detection.score);
 * }
 * trivet_free_result(result);
 * trivet_close(library);
 * @endcode
 *
 * Errors: a function that can fail returns a trivet_status, and writes a sentence into the
 * trivet_error that it is given; nothing is thrown, and nothing ends the process. Wrong arguments,
 * null pointers among them, are TRIVET_USAGE; a pointer to memory that is not there is not noticed.
 *
 * Threads: all functions may be called from any thread. A library may be recognized with by many
 * threads at once, and a result may be read by many; only freeing a thing must be the last use of
 * it. Recognition itself uses all cores. Same input, same answer, whatever runs beside it.
 *
 * Memory: arrays that are given are read during the call only. Texts that are returned belong to
 * what they were asked of. Functions that free take NULL, too.
 */
#ifndef TRIVET_H
#define TRIVET_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
/** What the shared library shows. */
#define TRIVET_API __attribute__((visibility("default")))
#else
#define TRIVET_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** How a call ended: the numbers are the exit codes of the command line. */
typedef enum trivet_status {
  TRIVET_OK = 0,             /**< as it should */
  TRIVET_USAGE = 2,          /**< an argument or an option is wrong */
  TRIVET_BAD_DATA = 65,      /**< a file or a scan breaks its format, or cannot be used */
  TRIVET_MISSING_INPUT = 66, /**< a file that is named does not exist */
  TRIVET_CHANGED = 69,       /**< a file was changed by others while it was used; open it anew */
  TRIVET_INTERNAL = 70,      /**< a fault of the program */
  TRIVET_CANNOT_CREATE = 73, /**< a file or a folder cannot be made */
  TRIVET_IO = 74,            /**< reading failed, or memory ran out */
  TRIVET_STOPPED = 75        /**< it was stopped before its end */
} trivet_status;

/** Why a call failed. The caller's: a variable of this type is all that it takes. */
typedef struct trivet_error {
  int32_t status;     /**< what the call returned */
  char message[1020]; /**< a sentence in UTF-8, cut short if it is longer; empty after a success */
} trivet_error;

/** What lengths are in. */
typedef enum trivet_unit {
  TRIVET_UNIT_OF_LIBRARY = 0, /**< that of the library's models */
  TRIVET_METER = 1,           /**< m */
  TRIVET_MILLIMETER = 2       /**< mm */
} trivet_unit;

/** What the numbers of an array are. */
typedef enum trivet_number {
  TRIVET_FLOAT32 = 0, /**< float */
  TRIVET_FLOAT64 = 1, /**< double */
  TRIVET_UINT16 = 2   /**< uint16_t */
} trivet_number;

/** A library that is open. */
typedef struct trivet_library trivet_library;
/** What was found in a scene. */
typedef struct trivet_result trivet_result;
/** Asks calls to end early. */
typedef struct trivet_stopper trivet_stopper;

/**
 * Pinhole camera, x right, y down, z forward: u = fx x / z + cx, v = fy y / z + cy [pixel]. What is zero from `distortion` on is not
 * said: no distortion, depths along z, images of any size.
 */
typedef struct trivet_camera {
  double fx; /**< focal length along a row [pixel], above 0 */
  double fy; /**< focal length along a column [pixel], above 0 */
  double cx; /**< column of the principal point [pixel], 0 at the center of the first pixel */
  double cy; /**< row of the principal point [pixel] */
  double depth_scale;   /**< a depth times it is a length in the scene's unit, above 0 */
  double distortion[8]; /**< Brown-Conrady, in OpenCV's order: k1 k2 p1 p2 k3 k4 k5 k6; undone */
  uint32_t depth_along_ray; /**< 1: depths are distances from the camera, along the ray; 0: z */
  uint32_t width;           /**< of the images that the other numbers are for [pixel], or 0 */
  uint32_t height;          /**< likewise; an image of another size is refused */
} trivet_camera;

/** An object that was found. Lengths are in the scene's unit. */
typedef struct trivet_detection {
  /** 4 x 4, row after row: takes a point of the model to its place in the scene. */
  double pose[16];
  uint32_t model;            /**< index, below trivet_num_models */
  uint32_t num_alternatives; /**< other poses that the scan cannot tell from this one */
  float score;               /**< probability that it is there, in this pose or an alternative */
  float pose_share;          /**< of the score, what is this very pose's, 0..1 */
  float visible_fraction;    /**< share of the silhouette that was measured as the pose says */
  float hidden_fraction;     /**< share of it behind something nearer */
  float outside_fraction;    /**< share of it beyond the borders of the scan */
  float violation;           /**< share of what was measured there that the sensor looked through */
  float contour;             /**< share of the outline that the scene does not run on beyond */
  float rmse;                /**< root mean square distance of both surfaces where they agree */
} trivet_detection;

/** What the scan was, and what it took. */
typedef struct trivet_scene {
  uint64_t num_points;  /**< that were used */
  uint64_t num_invalid; /**< that were dropped, as a coordinate was not finite */
  double noise;         /**< standard deviation of the measured surface, in the scene's unit */
  double seconds;       /**< that recognition took */
} trivet_scene;

/** The version of this library, "MAJOR.MINOR.PATCH". */
TRIVET_API const char* trivet_version(void);

/**
 * Open a library that `trivet train` made. It is mapped: thousands of models open in milliseconds.
 *
 * @param file         path of the library
 * @param calibration  path of a score that `trivet calibrate` made, or NULL
 * @param[out] library to be closed by trivet_close; NULL after an error
 * @param[out] error   or NULL
 * @return TRIVET_OK, TRIVET_USAGE, TRIVET_BAD_DATA, TRIVET_MISSING_INPUT or TRIVET_IO
 */
TRIVET_API trivet_status trivet_open(const char* file, const char* calibration,
                                     trivet_library** library, trivet_error* error);

/**
 * Close a library. What was recognized with it stays.
 *
 * @param library  or NULL; used by no other thread any more
 */
TRIVET_API void trivet_close(trivet_library* library);

/**
 * How many models a library has; they are sorted by name.
 *
 * @param library  or NULL, which has none
 */
TRIVET_API size_t trivet_num_models(const trivet_library* library);

/**
 * A model's name, which lives as long as the library is open; NULL of an index that is too large.
 *
 * @param library  or NULL
 * @param model    index, below trivet_num_models
 */
TRIVET_API const char* trivet_model_name(const trivet_library* library, size_t model);

/**
 * The largest distance between two points of a model, in the library's unit; 0 of an index that is
 * too large.
 *
 * @param library  or NULL
 * @param model    index, below trivet_num_models
 */
TRIVET_API double trivet_model_diameter(const trivet_library* library, size_t model);

/**
 * What the library's lengths are in: TRIVET_METER or TRIVET_MILLIMETER; TRIVET_UNIT_OF_LIBRARY of
 * NULL.
 *
 * @param library  or NULL
 */
TRIVET_API trivet_unit trivet_library_unit(const trivet_library* library);

/**
 * Find the models in points. The answer is that of `trivet recognize` on a file of these points.
 *
 * @param library    to recognize with
 * @param xyz        three coordinates a point, at multiples of their size; points with one that is
 *                   not finite are dropped and counted; where coordinates are large beside their
 *                   extent, as those of maps, give doubles
 * @param number     TRIVET_FLOAT32 or TRIVET_FLOAT64
 * @param width      number of points; of an organized scan, those of a row
 * @param height     1; of an organized scan, its number of rows: then the sensor is at the origin
 *                   unless `viewpoint` says otherwise, and points at (0, 0, 0) are dropped
 * @param stride     numbers from one point to the next, at least 3: 3 where nothing lies between
 * @param viewpoint  x, y, z of the sensor, in the frame and unit of the points; NULL: the origin
 * @param unit       of the points
 * @param options    texts "name=value", at their end NULL; or NULL. Names and values are those of
 *                   `trivet recognize --help`, without dashes: "min-score=0.9", "preset=fast"
 * @param stopper    or NULL
 * @param[out] result  to be freed by trivet_free_result; NULL after an error
 * @param[out] error   or NULL
 * @return TRIVET_OK, TRIVET_USAGE, TRIVET_BAD_DATA (no point, none that is finite, too many, too
 *         far away, sizes that do not match the library's, a library that is damaged),
 *         TRIVET_STOPPED, TRIVET_IO (no memory) or TRIVET_INTERNAL
 */
TRIVET_API trivet_status trivet_recognize_points(const trivet_library* library, const void* xyz,
                                                 trivet_number number, size_t width, size_t height,
                                                 size_t stride, const double* viewpoint,
                                                 trivet_unit unit, const char* const* options,
                                                 const trivet_stopper* stopper,
                                                 trivet_result** result, trivet_error* error);

/**
 * Find the models in a depth image. The answer is that of `trivet recognize` on a file of it. Poses
 * are in the frame of the camera.
 *
 * @param library  to recognize with
 * @param depths   `height` rows of `width` numbers, at multiples of their size, from the top left;
 *                 zero, negative and not finite ones are no measurement
 * @param number   TRIVET_UINT16, TRIVET_FLOAT32 or TRIVET_FLOAT64
 * @param width    [pixel]
 * @param height   [pixel]
 * @param stride   numbers from one row to the next, at least `width`
 * @param camera   that took it
 * @param unit     that camera->depth_scale gives
 * @param options  as above
 * @param stopper  or NULL
 * @param[out] result  to be freed by trivet_free_result; NULL after an error
 * @param[out] error   or NULL
 * @return as above; TRIVET_BAD_DATA also of a camera that cannot be or is of another image's size, and of
 *         negative depths only
 */
TRIVET_API trivet_status trivet_recognize_depth(const trivet_library* library, const void* depths,
                                                trivet_number number, size_t width, size_t height,
                                                size_t stride, const trivet_camera* camera,
                                                trivet_unit unit, const char* const* options,
                                                const trivet_stopper* stopper,
                                                trivet_result** result, trivet_error* error);

/**
 * How many objects were found.
 *
 * @param result  or NULL, which has none
 */
TRIVET_API size_t trivet_num_detections(const trivet_result* result);

/**
 * Copy what is known of an object that was found. They are sorted by falling score, then by name.
 *
 * @param result     of a recognition
 * @param index      below trivet_num_detections
 * @param[out] detection  unchanged after an error
 * @return TRIVET_OK, or TRIVET_USAGE of an index that is too large
 */
TRIVET_API trivet_status trivet_get_detection(const trivet_result* result, size_t index,
                                              trivet_detection* detection);

/**
 * Copy another pose of an object that the scan cannot tell from the one that is told.
 *
 * @param result       of a recognition
 * @param index        of the detection
 * @param alternative  below its num_alternatives
 * @param[out] pose    16 numbers, as trivet_detection::pose; unchanged after an error
 * @return TRIVET_OK, or TRIVET_USAGE of an index that is too large
 */
TRIVET_API trivet_status trivet_get_alternative(const trivet_result* result, size_t index,
                                                size_t alternative, double* pose);

/**
 * Copy what is known of the scan.
 *
 * @param result      of a recognition
 * @param[out] scene  unchanged after an error
 * @return TRIVET_OK, or TRIVET_USAGE of a null pointer
 */
TRIVET_API trivet_status trivet_get_scene(const trivet_result* result, trivet_scene* scene);

/**
 * Free a result.
 *
 * @param result  or NULL; used by no other thread any more
 */
TRIVET_API void trivet_free_result(trivet_result* result);

/** Make what can stop calls; NULL if there is no memory. To be freed by trivet_free_stopper. */
TRIVET_API trivet_stopper* trivet_new_stopper(void);

/**
 * Ask all calls with this stopper to end, those to come too: at the end of the step that they are
 * in, mostly within a fraction of a second. They return TRIVET_STOPPED.
 *
 * @param stopper  or NULL
 */
TRIVET_API void trivet_stop(trivet_stopper* stopper);

/**
 * Free a stopper. Calls that still run with it are not stopped.
 *
 * @param stopper  or NULL; used by no other thread any more, but for calls that run with it
 */
TRIVET_API void trivet_free_stopper(trivet_stopper* stopper);

#ifdef __cplusplus
}
#endif

#endif
