// ---- Theme: light, dark or as the system has it; colours that do not come from the style sheet.

// Told apart by colour-blind readers (after Okabe and Ito), at least 3 : 1 against the plots' background; dashes say the same.
const seriesColours = {
  light: ['#0072b2', '#c44e00', '#00795a', '#a8447f', '#8a6a00', '#3b5bdb', '#6b6b6b', '#8c2d04'],
  dark: ['#56b4e9', '#f0894a', '#35c79a', '#e08fc0', '#e6b422', '#9aaeff', '#b5b5b5', '#ffb199'],
};
const seriesDashes = [[], [7, 4], [2, 3], [9, 3, 2, 3], [12, 4], [4, 2], [1, 2], [6, 2, 1, 2, 1, 2]];

// Muted, so that ropes and forces stand out.
const boxColours = {
  light: {focus: '#e8913c', container: ['#7d95a8', '#93a58f', '#a89a84', '#8f8fa8', '#a3898c', '#7fa0a0'], body: '#8f9aa3', machine: '#5a646d',
    spreader: '#c9a227', left_out: '#b5b5b0', ground: '#dcddd8', grid: '#c3c5c0', shadow: '#c6c8c3', edge: '#23292e', rail: '#6d767e', force: '#b3003c', fog: '#eceeed'},
  dark: {focus: '#d98a3d', container: ['#5f7687', '#6c7f6a', '#80745f', '#6b6b86', '#7d6669', '#5c7b7b'], body: '#6c7780', machine: '#8b959e',
    spreader: '#c9a227', left_out: '#4b4f53', ground: '#23282c', grid: '#363c42', shadow: '#171a1d', edge: '#0b0d0f', rail: '#7d868e', force: '#ff7096', fog: '#171c21'},
};

// Cividis from slack to the largest tension: even in lightness, the same to colour-blind readers.
const rampStops = {light: ['#00204d', '#31446b', '#666970', '#958f78', '#cbba69', '#ffea46'], dark: ['#4f74c4', '#6d88b0', '#8d9a9c', '#b0a985', '#d8c56a', '#ffea46']};
function ramp(part) {
  const stops = rampStops[theme.name], x = Math.min(Math.max(part, 0), 1) * (stops.length - 1), i = Math.min(Math.floor(x), stops.length - 2);
  const a = rgb(stops[i]), b = rgb(stops[i + 1]);
  return a.map((v, k) => v + (x - i) * (b[k] - v));
}
const rampCss = () => `linear-gradient(90deg, ${rampStops[theme.name].join(', ')})`;

const rgbCache = new Map();
function rgb(hex) {
  if (!rgbCache.has(hex)) rgbCache.set(hex, [1, 3, 5].map(i => parseInt(hex.slice(i, i + 2), 16) / 255));
  return rgbCache.get(hex);
}

const theme = {
  listeners: [],
  system: matchMedia('(prefers-color-scheme: dark)'),
  get chosen() { return document.documentElement.dataset.theme || 'auto'; },
  get name() { return this.chosen === 'auto' ? (this.system.matches ? 'dark' : 'light') : this.chosen; },
  set(choice) {
    if (choice === 'auto') delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = choice;
    this.changed();
  },
  changed() { for (const listener of this.listeners) listener(); },
  css(name) { return getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim(); },
  series(i) { return seriesColours[this.name][i % 8]; },
  get boxes() { return boxColours[this.name]; },
};
theme.system.addEventListener('change', () => theme.changed());
// Paper is white.
let beforePrint = null;
addEventListener('beforeprint', () => { beforePrint = theme.chosen; theme.set('light'); });
addEventListener('afterprint', () => { if (beforePrint) theme.set(beforePrint); beforePrint = null; });

function themeButton() {
  const order = ['auto', 'light', 'dark'], label = {auto: '◐ System', light: '○ Light', dark: '● Dark'};
  const button = element('button', {class: 'quiet', id: 'theme', title: 'Theme', 'aria-description': 'Theme of the page', onclick: () => {
    theme.set(order[(order.indexOf(theme.chosen) + 1) % 3]);
    button.textContent = label[theme.chosen];
  }}, label[theme.chosen]);
  return button;
}
