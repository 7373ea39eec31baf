//! The image: what a camera sees of the light.

mod aims;
mod camera;
mod exact_light;
mod film;
mod final_gather;
mod gather_points;
mod normal_maps;
mod openings;
mod phong;
mod shading;
mod specular;
mod spots;
mod textures;
