//! basis_universal's UASTC encoder, called as its C interface calls it and as C++ programs do.

use std::ffi::c_void;
use std::ptr::null_mut;
use std::slice;

use basisu_c_sys::common::{BTF_UASTC_LDR_4X4, BU_COMP_FLAGS_KTX2_OUTPUT, BU_COMP_FLAGS_THREADED};
use basisu_c_sys::encoder as c;

use crate::Failure;

/// The function of the library to call.
#[derive(Clone, Copy, PartialEq)]
pub enum Interface {
    /// `basisu::basis_compress`, which only encodes.
    Plain,
    /// `bu_compress_texture`, the C interface, which always computes PSNR, SSIM and PSNR-HVS-M as well.
    Statistics,
}

unsafe extern "C" {
    /// Calls `basisu::basis_compress` for one image. The C interface hides the last parameter, which turns statistics
    /// off.
    #[link_name = "_ZN6basisu14basis_compressEN6basist16basis_tex_formatEPKhjjjjfPmPNS_11image_statsE"]
    fn basis_compress(
        format: u32,
        rgba: *const u8,
        width: u32,
        height: u32,
        pitch_in_pixels: u32,
        flags: u32,
        rdo: f32,
        size: *mut usize,
        statistics: *mut c_void,
    ) -> *mut c_void;

    #[link_name = "_ZN6basisu15basis_free_dataEPv"]
    fn basis_free_data(data: *mut c_void);
}

/// Builds the library's tables, before the clock starts.
pub fn prepare() {
    // SAFETY: the function takes no arguments and may be called repeatedly.
    unsafe { c::bu_init() }
}

/// Encodes one level to a KTX2 file of UASTC without supercompression, on as many threads as there are cores. `rgba`
/// has `width * height` texels of 4 bytes; `level` is 0 (fastest) to 4.
///
/// # Errors
/// When the library returns no file.
pub fn encode(rgba: &[u8], width: u32, height: u32, level: u32, interface: Interface) -> Result<Vec<u8>, Failure> {
    assert_eq!(rgba.len(), width as usize * height as usize * 4);
    let flags = (BU_COMP_FLAGS_THREADED | BU_COMP_FLAGS_KTX2_OUTPUT) as u32 | level;
    match interface {
        Interface::Plain => {
            let mut size = 0;
            // SAFETY: the image has that many texels. The returned file has `size` bytes, which the caller must free.
            unsafe {
                let image = rgba.as_ptr();
                let file =
                    basis_compress(BTF_UASTC_LDR_4X4, image, width, height, width, flags, 0.0, &mut size, null_mut());
                if file.is_null() {
                    return Err("basis_universal gave no file".into());
                }
                let bytes = slice::from_raw_parts(file.cast(), size).to_vec();
                basis_free_data(file);
                Ok(bytes)
            }
        }
        Interface::Statistics => {
            // SAFETY: addresses are passed as integers. The library copies the image, and the file lives as long as the
            // parameters.
            unsafe {
                let parameters = c::bu_new_comp_params();
                let image = rgba.as_ptr() as u64;
                let taken = c::bu_comp_params_set_image_rgba32(parameters, 0, image, width, height, 4 * width);
                let done = c::bu_compress_texture(parameters, BTF_UASTC_LDR_4X4, -1, -1, u64::from(flags), 0.0);
                let (at, size) =
                    (c::bu_comp_params_get_comp_data_ofs(parameters), c::bu_comp_params_get_comp_data_size(parameters));
                let file = match taken.0 != 0 && done.0 != 0 && at != 0 {
                    true => Ok(slice::from_raw_parts(at as *const u8, size as usize).to_vec()),
                    false => Err("basis_universal gave no file".into()),
                };
                let _ = c::bu_delete_comp_params(parameters);
                file
            }
        }
    }
}
