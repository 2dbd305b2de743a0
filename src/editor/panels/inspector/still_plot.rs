use egui_plot::Plot;

/// A plot that shows all of itself and does not move: the wheel and the drag belong to the panel that it
/// stands in. Height in points.
pub(super) fn still_plot<'a>(id: &str, height: f32) -> Plot<'a> {
    Plot::new(id)
        .height(height)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
}
