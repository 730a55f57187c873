//! Animations: curves of nodes over time, sampled in f64.

use std::collections::BTreeMap;

use ::gltf::animation::{Interpolation, Property};
use glam::{DQuat, DVec3};

use super::accessor::Arrays;
use super::gltf::broken;
use super::nodes::{Nodes, Place};
use crate::FileError;

/// How the nodes of a character move over time.
#[derive(Clone, Debug)]
pub struct Animation {
    /// Its name, or its number where it has none.
    pub name: String,
    /// When its last key is, in seconds; 0 for a pose.
    pub seconds: f64,
    channels: Vec<Channel>,
}

/// One property of one node.
#[derive(Clone, Debug)]
struct Channel {
    node: usize,
    property: Property,
    interpolation: Interpolation,
    /// Ascending; at least one.
    times: Vec<f32>,
    /// So many numbers a key.
    width: usize,
    /// For each key its value; with cubic splines its in-tangent, its value and its out-tangent.
    values: Vec<f32>,
}

/// What an animation has made of the nodes.
#[derive(Debug)]
pub(super) struct Moved {
    pub(super) nodes: Vec<Place>,
    pub(super) weights: BTreeMap<usize, Vec<f64>>,
}

impl Moved {
    pub(super) fn new(nodes: &Nodes) -> Self {
        Self { nodes: nodes.rest.clone(), weights: BTreeMap::new() }
    }
}

impl Animation {
    /// # Errors
    /// Times that do not ascend, or another number of values than they need.
    pub(super) fn new(arrays: Arrays<'_>, animation: &::gltf::Animation<'_>) -> Result<Self, FileError> {
        let index = animation.index();
        let channels = animation.channels().enumerate();
        let read = |(place, channel)| Channel::new(arrays, &channel, &format!("animation {index}, channel {place}"));
        let channels = channels.map(read).collect::<Result<Vec<_>, _>>()?;
        let last = channels.iter().filter_map(|channel| channel.times.last()).copied();
        Ok(Self {
            name: animation.name().map_or_else(|| index.to_string(), str::to_owned),
            seconds: f64::from(last.fold(0.0, f32::max)),
            channels,
        })
    }

    /// Puts the nodes that it moves where they are at a time.
    pub(super) fn apply(&self, seconds: f64, moved: &mut Moved) {
        for channel in &self.channels {
            let value = channel.at(seconds);
            let Some(node) = moved.nodes.get_mut(channel.node) else { continue };
            match (channel.property, &value[..]) {
                (Property::Translation, &[x, y, z]) => node.translation = DVec3::new(x, y, z),
                (Property::Scale, &[x, y, z]) => node.scale = DVec3::new(x, y, z),
                (Property::Rotation, &[x, y, z, w]) => node.rotation = DQuat::from_xyzw(x, y, z, w),
                _ => drop(moved.weights.insert(channel.node, value)),
            }
        }
    }
}

impl Channel {
    fn new(arrays: Arrays<'_>, channel: &::gltf::animation::Channel<'_>, field: &str) -> Result<Self, FileError> {
        let (sampler, target) = (channel.sampler(), channel.target());
        let times = arrays.floats::<1>(&sampler.input(), &format!("{field}, times"), None)?.into_flattened();
        if !times.is_sorted_by(|one, next| one < next) {
            return Err(broken(arrays.name, format!("{field}, times"), "they do not ascend"));
        }
        let (output, label) = (sampler.output(), format!("{field}, values"));
        let interpolation = sampler.interpolation();
        let a_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let keys = times.len() * a_key;
        let values = match target.property() {
            Property::Translation | Property::Scale => {
                arrays.floats::<3>(&output, &label, Some(keys))?.into_flattened()
            }
            Property::Rotation => arrays.floats::<4>(&output, &label, Some(keys))?.into_flattened(),
            Property::MorphTargetWeights => arrays.floats::<1>(&output, &label, None)?.into_flattened(),
        };
        if values.is_empty() || values.len() % keys != 0 {
            return Err(broken(arrays.name, label, "their number is no multiple of that of the times"));
        }
        let width = values.len() / keys;
        let (node, property) = (target.node().index(), target.property());
        let read = Self { node, property, interpolation, times, width, values };
        if property == Property::Rotation && (0..read.times.len()).any(|key| !has_length(&read.value(key, 0))) {
            return Err(broken(arrays.name, label, "a rotation has no length"));
        }
        Ok(read)
    }

    /// A number of a key: its value, or the tangent behind (1) or before (-1) it.
    fn value(&self, key: usize, side: isize) -> Vec<f64> {
        let entry = match self.interpolation {
            Interpolation::CubicSpline => (3 * key + 1).wrapping_add_signed(side),
            _ => key,
        };
        self.values[entry * self.width..][..self.width].iter().map(|&value| f64::from(value)).collect()
    }

    /// Its value at a time.
    fn at(&self, seconds: f64) -> Vec<f64> {
        let behind = self.times.partition_point(|&time| f64::from(time) <= seconds);
        let value = if behind == 0 || behind == self.times.len() {
            self.value(behind.saturating_sub(1), 0)
        } else {
            let [start, end] = [behind - 1, behind].map(|key| f64::from(self.times[key]));
            self.between(behind - 1, (seconds - start) / (end - start), end - start)
        };
        if self.property == Property::Rotation { unit(value) } else { value }
    }

    /// The value at a share of the way from a key to the next, which is `length` seconds long.
    fn between(&self, key: usize, t: f64, length: f64) -> Vec<f64> {
        let (one, next) = (self.value(key, 0), self.value(key + 1, 0));
        match self.interpolation {
            Interpolation::Step => one,
            Interpolation::Linear if self.property == Property::Rotation => {
                let [one, next] = [one, next].map(|value| DQuat::from_slice(&unit(value)));
                one.slerp(next, t).to_array().to_vec()
            }
            Interpolation::Linear => one.iter().zip(&next).map(|(one, next)| one + (next - one) * t).collect(),
            Interpolation::CubicSpline => {
                let (out, into) = (self.value(key, 1), self.value(key + 1, -1));
                let (t2, t3) = (t * t, t * t * t);
                let parts =
                    [2.0 * t3 - 3.0 * t2 + 1.0, length * (t3 - 2.0 * t2 + t), 3.0 * t2 - 2.0 * t3, length * (t3 - t2)];
                let at = |i: usize| parts[0] * one[i] + parts[1] * out[i] + parts[2] * next[i] + parts[3] * into[i];
                (0..self.width).map(at).collect()
            }
        }
    }
}

fn has_length(value: &[f64]) -> bool {
    value.iter().map(|part| part * part).sum::<f64>() > 1e-12
}

/// A rotation of length 1; none where it has no length.
fn unit(value: Vec<f64>) -> Vec<f64> {
    let rotation = DQuat::from_slice(&value);
    let rotation = if has_length(&value) { rotation.normalize() } else { DQuat::IDENTITY };
    rotation.to_array().to_vec()
}
