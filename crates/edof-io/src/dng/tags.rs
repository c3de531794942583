//! Tags of TIFF and DNG that are read, by the names of their specifications. `docs/dng.md` has a row for each tag there is.

/// A tag: its number and the name that its specification gives it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tag(pub u16, pub &'static str);

impl std::fmt::Display for Tag {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({})", self.1, self.0)
    }
}

/// Defines a constant for each tag, and the list of them all.
macro_rules! tags {
    ($($constant:ident = $number:literal $name:literal;)*) => {
        $(pub const $constant: Tag = Tag($number, $name);)*
        /// All of them, in the order of their numbers.
        #[cfg(test)]
        pub const ALL: &[Tag] = &[$($constant),*];
    };
}

tags! {
    NEW_SUBFILE_TYPE = 254 "NewSubFileType";
    SUBFILE_TYPE = 255 "SubfileType";
    WIDTH = 256 "ImageWidth";
    HEIGHT = 257 "ImageLength";
    BITS = 258 "BitsPerSample";
    COMPRESSION = 259 "Compression";
    INTERPRETATION = 262 "PhotometricInterpretation";
    FILL_ORDER = 266 "FillOrder";
    STRIP_OFFSETS = 273 "StripOffsets";
    ORIENTATION = 274 "Orientation";
    SAMPLES = 277 "SamplesPerPixel";
    STRIP_ROWS = 278 "RowsPerStrip";
    STRIP_BYTES = 279 "StripByteCounts";
    PREDICTOR = 317 "Predictor";
    TILE_WIDTH = 322 "TileWidth";
    TILE_HEIGHT = 323 "TileLength";
    TILE_OFFSETS = 324 "TileOffsets";
    TILE_BYTES = 325 "TileByteCounts";
    SUB_DIRECTORIES = 330 "SubIFDs";
    SAMPLE_FORMAT = 339 "SampleFormat";
    JPEG_TABLES = 347 "JPEGTables";
    CFA_SIZE = 33421 "CFARepeatPatternDim";
    CFA = 33422 "CFAPattern";
    VERSION = 50706 "DNGVersion";
    BACKWARD_VERSION = 50707 "DNGBackwardVersion";
    CFA_COLOURS = 50710 "CFAPlaneColor";
    CFA_LAYOUT = 50711 "CFALayout";
    LINEARIZATION = 50712 "LinearizationTable";
    BLACK_SIZE = 50713 "BlackLevelRepeatDim";
    BLACK_LEVEL = 50714 "BlackLevel";
    BLACK_DELTA_H = 50715 "BlackLevelDeltaH";
    BLACK_DELTA_V = 50716 "BlackLevelDeltaV";
    WHITE_LEVEL = 50717 "WhiteLevel";
    DEFAULT_SCALE = 50718 "DefaultScale";
    CROP_ORIGIN = 50719 "DefaultCropOrigin";
    CROP_SIZE = 50720 "DefaultCropSize";
    COLOUR_MATRIX_1 = 50721 "ColorMatrix1";
    COLOUR_MATRIX_2 = 50722 "ColorMatrix2";
    CALIBRATION_1 = 50723 "CameraCalibration1";
    CALIBRATION_2 = 50724 "CameraCalibration2";
    ANALOG_BALANCE = 50727 "AnalogBalance";
    NEUTRAL = 50728 "AsShotNeutral";
    WHITE_XY = 50729 "AsShotWhiteXY";
    BASELINE_EXPOSURE = 50730 "BaselineExposure";
    ILLUMINANT_1 = 50778 "CalibrationIlluminant1";
    ILLUMINANT_2 = 50779 "CalibrationIlluminant2";
    ACTIVE_AREA = 50829 "ActiveArea";
    MASKED_AREAS = 50830 "MaskedAreas";
    COLORIMETRIC_REFERENCE = 50879 "ColorimetricReference";
    CALIBRATION_SIGNATURE = 50931 "CameraCalibrationSignature";
    PROFILE_SIGNATURE = 50932 "ProfileCalibrationSignature";
    HUE_SAT_DIMS = 50937 "ProfileHueSatMapDims";
    HUE_SAT_1 = 50938 "ProfileHueSatMapData1";
    HUE_SAT_2 = 50939 "ProfileHueSatMapData2";
    TONE_CURVE = 50940 "ProfileToneCurve";
    FORWARD_MATRIX_1 = 50964 "ForwardMatrix1";
    FORWARD_MATRIX_2 = 50965 "ForwardMatrix2";
    SUB_TILE_BLOCK = 50974 "SubTileBlockSize";
    ROW_INTERLEAVE = 50975 "RowInterleaveFactor";
    LOOK_DIMS = 50981 "ProfileLookTableDims";
    LOOK_TABLE = 50982 "ProfileLookTableData";
    OPCODES_1 = 51008 "OpcodeList1";
    OPCODES_2 = 51009 "OpcodeList2";
    OPCODES_3 = 51022 "OpcodeList3";
    EXPOSURE_OFFSET = 51109 "BaselineExposureOffset";
    USER_CROP = 51125 "DefaultUserCrop";
    GAIN_TABLE_MAP = 52525 "ProfileGainTableMap";
    ILLUMINANT_3 = 52529 "CalibrationIlluminant3";
    CALIBRATION_3 = 52530 "CameraCalibration3";
    COLOUR_MATRIX_3 = 52531 "ColorMatrix3";
    FORWARD_MATRIX_3 = 52532 "ForwardMatrix3";
    ILLUMINANT_DATA_1 = 52533 "IlluminantData1";
    ILLUMINANT_DATA_2 = 52534 "IlluminantData2";
    ILLUMINANT_DATA_3 = 52535 "IlluminantData3";
    HUE_SAT_3 = 52537 "ProfileHueSatMapData3";
    RGB_TABLES = 52543 "RGBTables";
    GAIN_TABLE_MAP_2 = 52544 "ProfileGainTableMap2";
    COLUMN_INTERLEAVE = 52547 "ColumnInterleaveFactor";
}
