%TRENDID_IDENTIFY  Continuous-time model of a servo drive from samples, with its uncertainty.
%
%   found = trendid_identify(t_sample, u, y, 'order', 3, 'integrator', true, ...)
%
%   t_sample   sample time [s]
%   u          command, one column per input (1 or 2) [unit of u]; a row counts as one input
%   y          position [unit of y]
%
%   name           default          meaning
%   'order'        3                order m, 1 to 4
%   'integrator'   true             no a_0: the drive integrates
%   'zeros'        0                highest power of s in the numerators
%   'constant'     true             a constant input, for the offset of the valve
%   'initial'      true             the error of the first position is a parameter
%   'bandwidth'    20               rough bandwidth of the drive [rad/s], within a factor of three
%   'u_range'      max(abs(u))      typical size of each input
%   'y_range'      half its range   typical movement of y
%   'noise'        0                standard deviation of the noise of y; 0: a thousandth of y_range
%   'memory'       0                memory [s]; 0: nothing is forgotten
%   'settling'     0                time without estimation at the start [s]
%   'significance' 2                standard deviations below which the constant is withdrawn
%   'delay'        0                delay of each input [samples], up to 64, also between samples
%   'hold'         0                course of each input between samples: 0 held, 1 straight, 2 the mean since the one before
%   'follow_changes' false          with a memory: it is short while the drive changes
%
%   found.theta, found.std    parameters (a_i, b_i of each input, constant, initial state) and standard deviations
%   found.covariance          their covariance
%   found.a, found.b          a_0 .. a_(m-1) and b_0 .. b_(m-1) of the transfer function, a row per input
%   found.gain, .omega0, .damping with .._std, found.stable, found.constant
%   found.innovation          y minus its prediction, NaN where there was none
%   found.num, found.den      for tf(found.num{1}, found.den)
%
%   Computed in single precision by the same code as on a microcontroller, so the numbers are those of the target.
function found = trendid_identify(t_sample, u, y, varargin)
  if nargin < 3
    error('trendid:argument', 'sample time, u and y are needed');
  end
  % Counts come as integers, whose arithmetic would round and saturate everything that follows from them.
  t_sample = real_of(t_sample, 'the sample time', true);
  u = real_of(u, 'u', false);
  y = real_of(y, 'y', false);
  if ~isvector(y)
    error('trendid:argument', 'y has %d rows and %d columns, one position per sample is expected', size(y, 1), size(y, 2));
  end
  if isvector(u)
    u = u(:);
  end
  y = y(:);
  if size(u, 1) ~= numel(y)
    error('trendid:argument', 'u has %d samples, y has %d', size(u, 1), numel(y));
  end
  inputs = size(u, 2);
  if inputs < 1 || inputs > 2
    error('trendid:argument', 'u has %d inputs, 1 or 2 are possible', inputs);
  end
  set = struct('order', 3, 'integrator', true, 'zeros', 0, 'constant', true, 'initial', true, ...
               'bandwidth', 20, 'u_range', max(abs(u), [], 1), 'y_range', (max(y) - min(y)) / 2, ...
               'noise', 0, 'memory', 0, 'settling', 0, 'significance', 2, 'delay', 0, 'hold', 0, ...
               'follow_changes', false);
  if mod(numel(varargin), 2) ~= 0
    error('trendid:argument', 'options come in pairs of name and value');
  end
  for i = 1:2:numel(varargin)
    name = varargin{i};
    if ~ischar(name) || ~isfield(set, name)
      error('trendid:argument', 'no option %s', disp_name(name));
    end
    set.(name) = varargin{i + 1};
  end
  for name = {'order', 'zeros', 'bandwidth', 'y_range', 'noise', 'memory', 'settling', 'significance'}
    set.(name{1}) = real_of(set.(name{1}), name{1}, true);
  end
  for name = {'integrator', 'constant', 'initial', 'follow_changes'}
    set.(name{1}) = real_of(set.(name{1}), name{1}, true);
    if ~any(set.(name{1}) == [0, 1])
      error('trendid:argument', '%s = %g is neither true nor false', name{1}, set.(name{1}));
    end
  end
  for name = {'u_range', 'delay', 'hold'}
    set.(name{1}) = real_of(set.(name{1}), name{1}, false);
    if ~any(numel(set.(name{1})) == [1, inputs])
      error('trendid:argument', '%s has %d values, expected 1 or one per input', name{1}, numel(set.(name{1})));
    end
  end
  if ~any(set.order == 1:4)
    error('trendid:argument', 'order = %g is not 1, 2, 3 or 4', set.order);
  end
  if ~any(set.zeros == 0:set.order - 1)
    error('trendid:argument', 'zeros = %g is not within 0 to %d', set.zeros, set.order - 1);
  end
  pair = @(values, other) [values(:).' repmat(values(end), 1, inputs - numel(values)) ...
                           repmat(other, 1, 2 - inputs)];
  output_terms = 2 ^ set.order - 1 - set.integrator;
  input_terms = pair(repmat(2 ^ (set.zeros + 1) - 1, 1, inputs), 0);
  structure = [set.order, inputs, output_terms, input_terms, set.constant, set.initial];
  options = [pair(set.u_range, 1), set.y_range, set.noise, set.memory, set.settling, set.significance, ...
             pair(set.delay, 0), pair(set.hold, 0), set.follow_changes];
  [theta, std, model, innovation, covariance] = ...
      trendid_mex(t_sample, set.bandwidth, structure, u, y, options);
  found = model;
  found.theta = theta;
  found.std = std;
  found.covariance = covariance;
  found.innovation = innovation;
  found.den = [1, fliplr(model.a)];
  found.num = num2cell(fliplr(model.b), 2);
end

% Real numbers as double, one of them where `one` is true.
function value = real_of(value, name, one)
  if ~(isnumeric(value) || islogical(value)) || ~isreal(value) || (one && ~isscalar(value))
    if one
      what = 'one real number';
    else
      what = 'real numbers';
    end
    error('trendid:argument', '%s must be %s', name, what);
  end
  value = double(value);
end

function text = disp_name(name)
  if ischar(name)
    text = name;
  else
    text = '(not a name)';
  end
end
