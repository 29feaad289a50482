/**
 * @file
 * Recognize the models of a library in scans, from any language that can call C.
 *
 * Open a library, pass it points or a depth image, read the detections, free the result:
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
 * Errors: a function that can fail returns a trivet_status, and writes a message to its
 * trivet_error argument. No function throws or ends the process. Invalid arguments, including null
 * pointers, give TRIVET_USAGE; pointers to invalid memory are not detected.
 *
 * Threads: all functions may be called from any thread. Many threads may use one library for
 * recognition, or read one result, at the same time; freeing an object must be its last use.
 * Recognition itself uses all cores. Same input, same result, whatever runs in parallel.
 *
 * Memory: input arrays are read during the call only. Returned strings belong to the object that
 * returned them. Functions that free an object accept NULL.
 */
#ifndef TRIVET_H
#define TRIVET_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
/** Symbols that the shared library exports. */
#define TRIVET_API __attribute__((visibility("default")))
#else
#define TRIVET_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Status of a call. The numbers are the exit codes of the command line. */
typedef enum trivet_status {
  TRIVET_OK = 0,             /**< success */
  TRIVET_USAGE = 2,          /**< an argument or an option is invalid */
  TRIVET_BAD_DATA = 65,      /**< a file or a scan has an invalid format or is unusable */
  TRIVET_MISSING_INPUT = 66, /**< an input file does not exist */
  TRIVET_CHANGED = 69,       /**< others changed a file while it was in use; open it again */
  TRIVET_INTERNAL = 70,      /**< an internal error of the program */
  TRIVET_CANNOT_CREATE = 73, /**< a file or a folder cannot be created */
  TRIVET_IO = 74,            /**< reading failed, or memory ran out */
  TRIVET_STOPPED = 75        /**< stopped before completion */
} trivet_status;

/** Error of a call. The caller declares a variable of this type; it needs no initialization. */
typedef struct trivet_error {
  int32_t status;     /**< return value of the call */
  char message[1020]; /**< a sentence in UTF-8, truncated if necessary; empty on success */
} trivet_error;

/** Unit of lengths. */
typedef enum trivet_unit {
  TRIVET_UNIT_OF_LIBRARY = 0, /**< unit of the library's models */
  TRIVET_METER = 1,           /**< m */
  TRIVET_MILLIMETER = 2       /**< mm */
} trivet_unit;

/** Element type of an array. */
typedef enum trivet_number {
  TRIVET_FLOAT32 = 0, /**< float */
  TRIVET_FLOAT64 = 1, /**< double */
  TRIVET_UINT16 = 2   /**< uint16_t */
} trivet_number;

/** An open library. */
typedef struct trivet_library trivet_library;
/** Result of recognizing a scene. */
typedef struct trivet_result trivet_result;
/** Object for stop requests to calls. */
typedef struct trivet_stopper trivet_stopper;

/**
 * Pinhole camera, x right, y down, z forward: u = fx x / z + cx, v = fy y / z + cy [pixel]. From
 * `distortion` on, zero is the default: no distortion, depths along z, images of any size.
 */
typedef struct trivet_camera {
  double fx; /**< focal length along a row [pixel], above 0 */
  double fy; /**< focal length along a column [pixel], above 0 */
  double cx; /**< column of the principal point [pixel], 0 at the center of the first pixel */
  double cy; /**< row of the principal point [pixel] */
  double depth_scale;   /**< factor from depths to lengths in the scene's unit, above 0 */
  double distortion[8]; /**< Brown-Conrady, in OpenCV's order: k1 k2 p1 p2 k3 k4 k5 k6; corrected */
  uint32_t depth_along_ray; /**< 1: depths are distances along the ray; 0: along z */
  uint32_t width;           /**< width of the calibrated images [pixel], or 0 */
  uint32_t height;          /**< their height, or 0; images of another size are rejected */
} trivet_camera;

/** A detected object. Lengths are in the scene's unit. */
typedef struct trivet_detection {
  /** 4 x 4 matrix, row-major: maps points of the model to the scene. */
  double pose[16];
  uint32_t model;            /**< index below trivet_num_models */
  uint32_t num_alternatives; /**< number of poses that the scan cannot distinguish from it */
  float score;               /**< probability that the object is present, in any of these poses */
  float pose_share;          /**< share of the score that belongs to this exact pose, 0..1 */
  float visible_fraction;    /**< share of the silhouette where measurements agree with it */
  float hidden_fraction;     /**< share of the silhouette occluded by something nearer */
  float outside_fraction;    /**< share of the silhouette beyond the borders of the scan */
  float violation;           /**< share of the measured silhouette that the sensor saw through */
  float contour;             /**< share of the outline beyond which the scene ends */
  float rmse;                /**< root mean square distance of both surfaces where they agree */
} trivet_detection;

/** Properties of the scan and time of recognition. */
typedef struct trivet_scene {
  uint64_t num_points;  /**< number of points used */
  uint64_t num_invalid; /**< number of points dropped for a coordinate that is not finite */
  double noise;         /**< standard deviation of the measured surface, in the scene's unit */
  double seconds;       /**< duration of recognition */
} trivet_scene;

/** The version of this library, "MAJOR.MINOR.PATCH". */
TRIVET_API const char* trivet_version(void);

/**
 * Open a library written by `trivet train`. It is a mapped file, so thousands of models open in
 * milliseconds.
 *
 * @param file         path of the library
 * @param calibration  path of a score written by `trivet calibrate`, or NULL
 * @param[out] library receives the library, to be closed by trivet_close; NULL after an error
 * @param[out] error   receives the error, or NULL
 * @return TRIVET_OK, TRIVET_USAGE, TRIVET_BAD_DATA, TRIVET_MISSING_INPUT or TRIVET_IO
 */
TRIVET_API trivet_status trivet_open(const char* file, const char* calibration,
                                     trivet_library** library, trivet_error* error);

/**
 * Close a library. Results of recognition with it remain valid.
 *
 * @param library  library that no other thread uses any more, or NULL
 */
TRIVET_API void trivet_close(trivet_library* library);

/**
 * Number of models of a library. They are sorted by name.
 *
 * @param library  library, or NULL, which has none
 */
TRIVET_API size_t trivet_num_models(const trivet_library* library);

/**
 * A model's name, valid as long as the library is open; NULL if the index is too large.
 *
 * @param library  library, or NULL
 * @param model    index below trivet_num_models
 */
TRIVET_API const char* trivet_model_name(const trivet_library* library, size_t model);

/**
 * The largest distance between two points of a model, in the library's unit; 0 if the index is too
 * large.
 *
 * @param library  library, or NULL
 * @param model    index below trivet_num_models
 */
TRIVET_API double trivet_model_diameter(const trivet_library* library, size_t model);

/**
 * Unit of the library's lengths: TRIVET_METER or TRIVET_MILLIMETER; TRIVET_UNIT_OF_LIBRARY for
 * NULL.
 *
 * @param library  library, or NULL
 */
TRIVET_API trivet_unit trivet_library_unit(const trivet_library* library);

/**
 * Recognize the models in a point cloud. The result is that of `trivet recognize` for a file of
 * these points.
 *
 * @param library    library of the models
 * @param xyz        three coordinates per point, aligned to their size; points with a coordinate
 *                   that is not finite are dropped and counted; use doubles if coordinates are
 *                   large compared with their extent, as in maps
 * @param number     TRIVET_FLOAT32 or TRIVET_FLOAT64
 * @param width      number of points; for an organized scan, number of points per row
 * @param height     1; for an organized scan, number of rows. The sensor is then at the origin
 *                   unless `viewpoint` is given, and points at (0, 0, 0) are dropped
 * @param stride     numbers from one point to the next, at least 3; 3 for contiguous points
 * @param viewpoint  x, y, z of the sensor, in the frame and unit of the points; NULL: the origin
 * @param unit       unit of the points
 * @param options    strings "name=value", terminated by NULL; or NULL. Names and values are those
 *                   of `trivet recognize --help`, without dashes: "min-score=0.9", "preset=fast"
 * @param stopper    object for stop requests, or NULL
 * @param[out] result  receives the result, to be freed by trivet_free_result; NULL after an error
 * @param[out] error   receives the error, or NULL
 * @return TRIVET_OK, TRIVET_USAGE, TRIVET_BAD_DATA (no points, no finite ones, too many, too far
 *         away, sizes that do not match the library's, a damaged library),
 *         TRIVET_STOPPED, TRIVET_IO (no memory) or TRIVET_INTERNAL
 */
TRIVET_API trivet_status trivet_recognize_points(const trivet_library* library, const void* xyz,
                                                 trivet_number number, size_t width, size_t height,
                                                 size_t stride, const double* viewpoint,
                                                 trivet_unit unit, const char* const* options,
                                                 const trivet_stopper* stopper,
                                                 trivet_result** result, trivet_error* error);

/**
 * Recognize the models in a depth image. The result is that of `trivet recognize` for a file of the
 * image. Poses are in the frame of the camera.
 *
 * @param library  library of the models
 * @param depths   `height` rows of `width` numbers, aligned to their size, from the top left; zero,
 *                 negative and nonfinite numbers mean no measurement
 * @param number   TRIVET_UINT16, TRIVET_FLOAT32 or TRIVET_FLOAT64
 * @param width    [pixel]
 * @param height   [pixel]
 * @param stride   numbers from one row to the next, at least `width`
 * @param camera   camera of the image
 * @param unit     unit of depths multiplied by camera->depth_scale
 * @param options  as for trivet_recognize_points
 * @param stopper  object for stop requests, or NULL
 * @param[out] result  receives the result, to be freed by trivet_free_result; NULL after an error
 * @param[out] error   receives the error, or NULL
 * @return as for trivet_recognize_points; TRIVET_BAD_DATA also for an invalid camera, a camera for
 *         another image size, and an image that has negative depths only
 */
TRIVET_API trivet_status trivet_recognize_depth(const trivet_library* library, const void* depths,
                                                trivet_number number, size_t width, size_t height,
                                                size_t stride, const trivet_camera* camera,
                                                trivet_unit unit, const char* const* options,
                                                const trivet_stopper* stopper,
                                                trivet_result** result, trivet_error* error);

/**
 * Number of detected objects.
 *
 * @param result  result, or NULL, which has none
 */
TRIVET_API size_t trivet_num_detections(const trivet_result* result);

/**
 * Copy a detection. Detections are sorted by falling score, then by name.
 *
 * @param result     result of a recognition
 * @param index      index below trivet_num_detections
 * @param[out] detection  receives the detection; unchanged after an error
 * @return TRIVET_OK, or TRIVET_USAGE if the index is too large
 */
TRIVET_API trivet_status trivet_get_detection(const trivet_result* result, size_t index,
                                              trivet_detection* detection);

/**
 * Copy a pose of an object that the scan cannot distinguish from its reported pose.
 *
 * @param result       result of a recognition
 * @param index        index of the detection
 * @param alternative  index below its num_alternatives
 * @param[out] pose    receives 16 numbers, as in trivet_detection::pose; unchanged after an error
 * @return TRIVET_OK, or TRIVET_USAGE if the index is too large
 */
TRIVET_API trivet_status trivet_get_alternative(const trivet_result* result, size_t index,
                                                size_t alternative, double* pose);

/**
 * Copy the properties of the scan.
 *
 * @param result      result of a recognition
 * @param[out] scene  receives the properties; unchanged after an error
 * @return TRIVET_OK, or TRIVET_USAGE for a null pointer
 */
TRIVET_API trivet_status trivet_get_scene(const trivet_result* result, trivet_scene* scene);

/**
 * Free a result.
 *
 * @param result  result that no other thread uses any more, or NULL
 */
TRIVET_API void trivet_free_result(trivet_result* result);

/** Create a stopper, to be freed by trivet_free_stopper; NULL if there is no memory. */
TRIVET_API trivet_stopper* trivet_new_stopper(void);

/**
 * Ask all calls with this stopper to end, including later ones. They end after their current step,
 * usually within a fraction of a second, and return TRIVET_STOPPED.
 *
 * @param stopper  stopper, or NULL
 */
TRIVET_API void trivet_stop(trivet_stopper* stopper);

/**
 * Free a stopper. Calls that still run with it are not stopped.
 *
 * @param stopper  stopper that no other thread uses any more, except running calls; or NULL
 */
TRIVET_API void trivet_free_stopper(trivet_stopper* stopper);

#ifdef __cplusplus
}
#endif

#endif
