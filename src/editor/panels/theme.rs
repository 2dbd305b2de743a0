//! The look: two themes with one accent, quiet surfaces, and the picture as the brightest thing.

use super::super::preferences::{Preferences, ThemeChoice};
use bevy_egui::egui::epaint::AlphaFromCoverage;
use bevy_egui::egui::{
    self, Color32, CornerRadius, FontFamily, FontId, Mesh, Rect, Shadow, Stroke, StrokeKind, Style,
    TextStyle, Theme, ThemePreference, Visuals, pos2, vec2,
};

/// Seconds from press to release that are still a click: where frames take long a press is seen late.
const LONGEST_CLICK: f64 = 5.0;

/// The accent on dark surfaces, and on light ones.
const ACCENT: [Color32; 2] = [
    Color32::from_rgb(79, 188, 199),
    Color32::from_rgb(10, 110, 122),
];

/// The power of a letter's coverage that is its opacity on light surfaces; chosen by eye so that both themes look
/// equally bold.
const LIGHT_COVERAGE: f32 = 0.6;

/// Surfaces and inks of one theme, from the ground up.
struct Palette {
    /// Text fields, plots, the rails of sliders.
    well: Color32,
    panel: Color32,
    /// Popups, menus and windows.
    raised: Color32,
    /// Buttons at rest, under the pointer, pressed.
    button: [Color32; 3],
    line: Color32,
    /// Around what can be pressed, ticked or typed into at rest.
    edge: Stroke,
    /// Labels, what can be pressed, what is under the pointer.
    ink: [Color32; 3],
    /// Hints: less than a label, and still read at 4.5 to 1 on a panel (WCAG 2's AA).
    hint: Color32,
    selected: Color32,
    accent: Color32,
    warn: Color32,
    fault: Color32,
}

const DARK: Palette = Palette {
    well: Color32::from_rgb(18, 19, 22),
    panel: Color32::from_rgb(29, 31, 35),
    raised: Color32::from_rgb(38, 40, 45),
    button: [
        Color32::from_rgb(46, 49, 55),
        Color32::from_rgb(58, 62, 70),
        Color32::from_rgb(40, 74, 80),
    ],
    line: Color32::from_rgb(52, 55, 61),
    edge: Stroke::NONE,
    ink: [
        Color32::from_rgb(178, 183, 191),
        Color32::from_rgb(208, 212, 218),
        Color32::from_rgb(244, 246, 248),
    ],
    hint: Color32::from_rgb(139, 144, 153),
    selected: Color32::from_rgb(30, 78, 86),
    accent: ACCENT[0],
    warn: Color32::from_rgb(240, 176, 72),
    fault: Color32::from_rgb(244, 108, 100),
};

const LIGHT: Palette = Palette {
    well: Color32::from_rgb(255, 255, 255),
    panel: Color32::from_rgb(240, 241, 243),
    raised: Color32::from_rgb(244, 245, 247),
    button: [
        Color32::from_rgb(214, 218, 223),
        Color32::from_rgb(199, 205, 212),
        Color32::from_rgb(168, 214, 219),
    ],
    line: Color32::from_rgb(178, 183, 190),
    // Fills alone are lost beside white wells: an edge stands out at 3 to 1 (WCAG 2.2, 1.4.11).
    edge: Stroke {
        width: 1.0,
        color: Color32::from_rgb(130, 136, 144),
    },
    ink: [
        Color32::from_rgb(38, 42, 48),
        Color32::from_rgb(24, 27, 32),
        Color32::from_rgb(0, 0, 0),
    ],
    hint: Color32::from_rgb(82, 88, 97),
    selected: Color32::from_rgb(176, 220, 225),
    accent: ACCENT[1],
    warn: Color32::from_rgb(154, 90, 0),
    fault: Color32::from_rgb(184, 32, 32),
};

/// The colour of what is chosen, dragged or drawn by the editor over the picture.
pub(super) fn accent(ui: &egui::Ui) -> Color32 {
    ACCENT[usize::from(!ui.visuals().dark_mode)]
}

/// A bar that goes from colour to colour; one that has a single one is the same from end to end.
pub(super) fn gradient(place: Rect, colors: &[Color32]) -> Mesh {
    let mut mesh = Mesh::default();
    let last = colors.len().saturating_sub(1).max(1);
    for i in 0..=last {
        let Some(color) = colors.get(i).or_else(|| colors.last()) else {
            return mesh;
        };
        let x = place.min.x + place.width() * i as f32 / last as f32;
        mesh.colored_vertex(pos2(x, place.min.y), *color);
        mesh.colored_vertex(pos2(x, place.max.y), *color);
        if i > 0 {
            let at = 2 * i as u32;
            mesh.add_triangle(at - 2, at - 1, at);
            mesh.add_triangle(at - 1, at, at + 1);
        }
    }
    mesh
}

/// A ring around the control that Tab went to: rows and icons that are drawn by hand show it in no other way. What is typed
/// into shows it by its cursor.
pub(super) fn ring_ui(context: &egui::Context) {
    if context.text_edit_focused() {
        return;
    }
    let focused = context.memory(|memory| memory.focused());
    let Some(control) = focused.and_then(|id| context.read_response(id)) else {
        return;
    };
    if control.interact_rect.is_positive() {
        let dark = context.theme() == Theme::Dark;
        let ring = Stroke::new(1.5, ACCENT[usize::from(!dark)]);
        context.layer_painter(control.layer_id).rect_stroke(
            control.interact_rect,
            3.0,
            ring,
            StrokeKind::Outside,
        );
    }
}

/// Makes egui look as the preferences say; cheap where it does already.
pub(super) fn apply(context: &egui::Context, preferences: &Preferences) {
    let ours = egui::Id::new("glassbox-theme");
    if !context.data(|data| data.get_temp::<bool>(ours).unwrap_or(false)) {
        context.set_style_of(Theme::Dark, style(Theme::Dark));
        context.set_style_of(Theme::Light, style(Theme::Light));
        context.options_mut(|options| {
            options.input_options.max_click_duration = LONGEST_CLICK;
        });
        context.data_mut(|data| data.insert_temp(ours, true));
    }
    let wanted = match preferences.theme {
        ThemeChoice::System => ThemePreference::System,
        ThemeChoice::Dark => ThemePreference::Dark,
        ThemeChoice::Light => ThemePreference::Light,
    };
    if context.options(|options| options.theme_preference) != wanted {
        context.set_theme(wanted);
    }
}

fn style(theme: Theme) -> Style {
    let palette = match theme {
        Theme::Dark => DARK,
        Theme::Light => LIGHT,
    };
    let mut style = Style {
        visuals: visuals(theme, &palette),
        explanation_tooltips: false,
        animation_time: 0.08,
        ..Style::default()
    };
    let font = |size| FontId::new(size, FontFamily::Proportional);
    style.text_styles = [
        (TextStyle::Small, font(10.5)),
        (TextStyle::Body, font(13.0)),
        (TextStyle::Button, font(13.0)),
        (TextStyle::Heading, font(16.0)),
        (
            TextStyle::Monospace,
            FontId::new(12.0, FontFamily::Monospace),
        ),
    ]
    .into();
    style.drag_value_text_style = TextStyle::Body;
    let spacing = &mut style.spacing;
    spacing.item_spacing = vec2(6.0, 4.0);
    spacing.button_padding = vec2(6.0, 2.0);
    spacing.interact_size = vec2(36.0, 20.0);
    spacing.indent = 14.0;
    spacing.slider_width = 90.0;
    spacing.slider_rail_height = 4.0;
    spacing.combo_width = 90.0;
    spacing.tooltip_width = 320.0;
    spacing.menu_margin = egui::Margin::same(6);
    style.interaction.selectable_labels = false;
    style.interaction.tooltip_delay = 0.45;
    style
}

fn visuals(theme: Theme, palette: &Palette) -> Visuals {
    let mut visuals = theme.default_visuals();
    visuals.panel_fill = palette.panel;
    visuals.window_fill = palette.raised;
    visuals.window_stroke = Stroke::new(1.0, palette.line);
    visuals.extreme_bg_color = palette.well;
    // Every other row of a grid, which stands in popups and dialogs.
    visuals.faint_bg_color = palette.panel;
    visuals.code_bg_color = palette.button[0];
    visuals.weak_text_color = Some(palette.hint);
    visuals.hyperlink_color = palette.accent;
    visuals.warn_fg_color = palette.warn;
    visuals.error_fg_color = palette.fault;
    visuals.selection.bg_fill = palette.selected;
    visuals.selection.stroke = Stroke::new(1.0, palette.ink[2]);
    visuals.window_corner_radius = CornerRadius::same(6);
    visuals.menu_corner_radius = CornerRadius::same(5);
    if theme == Theme::Light {
        // Strokes thinner than a pixel fade more on light than on dark: what is half covered is inked for more.
        visuals.text_options.alpha_from_coverage = AlphaFromCoverage::Gamma(LIGHT_COVERAGE);
    }
    visuals.slider_trailing_fill = true;
    visuals.indent_has_left_vline = false;
    let shadow = Shadow {
        offset: [0, 4],
        blur: 14,
        spread: 0,
        color: Color32::from_black_alpha(if theme == Theme::Dark { 110 } else { 40 }),
    };
    visuals.window_shadow = shadow;
    visuals.popup_shadow = shadow;

    let radius = CornerRadius::same(3);
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.bg_fill = palette.panel;
    widgets.noninteractive.weak_bg_fill = palette.panel;
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, palette.line);
    widgets.noninteractive.fg_stroke = Stroke::new(1.0, palette.ink[0]);
    for (state, fill, stroke, ink) in [
        (
            &mut widgets.inactive,
            palette.button[0],
            palette.edge,
            palette.ink[1],
        ),
        (
            &mut widgets.hovered,
            palette.button[1],
            Stroke::new(1.0, palette.line),
            palette.ink[2],
        ),
        (
            &mut widgets.active,
            palette.button[2],
            Stroke::new(1.0, palette.accent),
            palette.ink[2],
        ),
        (
            &mut widgets.open,
            palette.button[1],
            Stroke::new(1.0, palette.line),
            palette.ink[2],
        ),
    ] {
        state.bg_fill = fill;
        state.weak_bg_fill = fill;
        state.bg_stroke = stroke;
        state.fg_stroke = Stroke::new(1.0, ink);
        state.corner_radius = radius;
        state.expansion = 0.0;
    }
    widgets.noninteractive.corner_radius = radius;
    visuals
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Contrast of two colours, 1 to 21 (WCAG 2.2, "contrast ratio").
    fn contrast(a: Color32, b: Color32) -> f32 {
        let luminance = |color: Color32| {
            let [r, g, b, _] = egui::Rgba::from(color).to_array();
            0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05
        };
        let ratio = luminance(a) / luminance(b);
        ratio.max(ratio.recip())
    }

    /// Whether text of this colour can be read on panels and windows of a theme (WCAG 2's AA).
    pub fn assert_readable(theme: Theme, ink: Color32, what: &str) {
        let visuals = style(theme).visuals;
        for paper in [visuals.panel_fill, visuals.window_fill] {
            let ratio = contrast(ink, paper);
            assert!(ratio >= 4.5, "{theme:?}: ink {what} at {ratio:.2} to 1");
        }
    }

    #[test]
    fn a_bar_has_each_colour_at_its_place() {
        let place = Rect::from_min_max(pos2(0.0, 0.0), pos2(20.0, 3.0));
        let (red, blue) = (Color32::RED, Color32::BLUE);
        let two = gradient(place, &[red, blue]);
        assert_eq!(two.vertices.len(), 4);
        assert_eq!(two.vertices[0].color, red);
        assert_eq!(two.vertices[2].color, blue);
        assert_eq!(two.vertices[3].pos, pos2(20.0, 3.0));
        assert_eq!(gradient(place, &[red]).vertices[2].color, red);
        assert!(gradient(place, &[]).is_empty());
    }

    #[test]
    fn an_empty_box_stands_out_from_a_light_panel() {
        let visuals = style(Theme::Light).visuals;
        let edge = visuals.widgets.inactive.bg_stroke;
        for paper in [visuals.panel_fill, visuals.window_fill] {
            let ratio = contrast(edge.color, paper);
            assert!(edge.width >= 1.0 && ratio >= 3.0, "{ratio:.2} to 1");
        }
    }

    #[test]
    fn every_text_can_be_read_in_both_themes() {
        for theme in [Theme::Dark, Theme::Light] {
            let visuals = style(theme).visuals;
            let inks = [
                visuals.text_color(),
                visuals.weak_text_color(),
                visuals.warn_fg_color,
                visuals.error_fg_color,
                visuals.hyperlink_color,
            ];
            for (i, ink) in inks.into_iter().enumerate() {
                assert_readable(theme, ink, &i.to_string());
            }
        }
    }
}
